# SPDX-License-Identifier: Apache-2.0
# lucerna_plugin(bsdfs/mirror [LIBRARY...]): makes the plugin `mirror` of the folder's kind from
# bsdfs/mirror.cpp, or from all .cpp files of the folder bsdfs/mirror/, and links the libraries
# given. The same function builds plugins outside of Lucerna's tree; there the result lies in
# <build>/plugins/bsdfs/mirror.so, ready for `lucerna --plugins <build>/plugins`.
#
# lucerna_shared(bsdfs/conductors): bsdfs/conductors.cpp, or all .cpp files of a folder of that
# name, is no plugin, but a part of several: they link `shared_bsdfs_conductors`.
include(GNUInstallDirs)

# As the core is compiled: NaN stays NaN, and the processor's mode is left alone.
function(lucerna_compile_as_plugin target)
    target_link_libraries(${target} PRIVATE Lucerna::core)
    if(TARGET lucerna_warnings)
        target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:lucerna_warnings>)
    endif()
    target_compile_options(${target} PRIVATE
        -fno-math-errno -fno-trapping-math -ffp-contract=off)
    set_target_properties(${target} PROPERTIES
        POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
    if(TARGET lucerna_precompiled AND NOT target STREQUAL "lucerna_precompiled")
        target_precompile_headers(${target} REUSE_FROM lucerna_precompiled)
    endif()
endfunction()

# The sources of a plugin or of a shared part.
function(lucerna_sources result path)
    set(sources ${path}.cpp)
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/${path} AND
       NOT EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${path}.cpp)
        file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${path}/*.cpp)
    endif()
    set(${result} ${sources} PARENT_SCOPE)
endfunction()

function(lucerna_shared path)
    string(REPLACE "/" "_" target "shared_${path}")
    lucerna_sources(sources ${path})
    add_library(${target} STATIC ${sources})
    lucerna_compile_as_plugin(${target})
endfunction()

function(lucerna_plugin path)
    string(REPLACE "/" "_" target "plugin_${path}")
    get_filename_component(folder ${path} DIRECTORY)
    get_filename_component(name ${path} NAME)
    lucerna_sources(sources ${path})
    add_library(${target} MODULE ${sources} $<TARGET_OBJECTS:lucerna_contracts>)
    lucerna_compile_as_plugin(${target})
    target_link_libraries(${target} PRIVATE ${ARGN})
    if(NOT LUCERNA_PLUGIN_OUTPUT_DIR)
        set(LUCERNA_PLUGIN_OUTPUT_DIR ${CMAKE_BINARY_DIR}/plugins)
    endif()
    set_target_properties(${target} PROPERTIES
        PREFIX "" OUTPUT_NAME ${name}
        LIBRARY_OUTPUT_DIRECTORY ${LUCERNA_PLUGIN_OUTPUT_DIR}/${folder}
        INSTALL_RPATH "$ORIGIN/../../..")
    if(TARGET program)
        add_dependencies(program ${target})
    endif()
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lucerna/plugins/${folder})
endfunction()
