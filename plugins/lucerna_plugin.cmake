# SPDX-License-Identifier: Apache-2.0
# lucerna_plugin(bsdfs/mirror [LIBRARY...]): makes the plugin `mirror` of the folder's kind from
# bsdfs/mirror.cpp, and links the libraries given. The same function builds plugins outside of
# Lucerna's tree; there the result lies in <build>/plugins/bsdfs/mirror.so, ready for
# `lucerna --plugins <build>/plugins`.
include(GNUInstallDirs)

function(lucerna_plugin path)
    string(REPLACE "/" "_" target "plugin_${path}")
    get_filename_component(folder ${path} DIRECTORY)
    get_filename_component(name ${path} NAME)
    add_library(${target} MODULE ${path}.cpp $<TARGET_OBJECTS:lucerna_contracts>)
    target_link_libraries(${target} PRIVATE Lucerna::core ${ARGN})
    if(TARGET lucerna_warnings)
        target_link_libraries(${target} PRIVATE lucerna_warnings)
    endif()
    # As the core is compiled: NaN stays NaN, and the processor's mode is left alone.
    target_compile_options(${target} PRIVATE
        -fno-math-errno -fno-trapping-math -ffp-contract=off)
    if(NOT LUCERNA_PLUGIN_OUTPUT_DIR)
        set(LUCERNA_PLUGIN_OUTPUT_DIR ${CMAKE_BINARY_DIR}/plugins)
    endif()
    set_target_properties(${target} PROPERTIES
        PREFIX "" OUTPUT_NAME ${name}
        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
        LIBRARY_OUTPUT_DIRECTORY ${LUCERNA_PLUGIN_OUTPUT_DIR}/${folder}
        INSTALL_RPATH "$ORIGIN/../../..")
    if(TARGET program)
        add_dependencies(program ${target})
    endif()
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lucerna/plugins/${folder})
endfunction()
