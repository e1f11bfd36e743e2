# SPDX-License-Identifier: Apache-2.0
# The page of `lucerna compare`, compiled into the command. Chart.js comes from a package of the
# distribution; building needs no Node.js.
find_file(LUCERNA_CHART_JS chart.min.js
          PATHS /usr/share/javascript/chart.js /usr/local/share/javascript/chart.js)
if(NOT LUCERNA_CHART_JS)
    message(FATAL_ERROR "chart.min.js was not found: install the package libjs-chart.js, or give "
                        "-DLUCERNA_CHART_JS=FILE (Chart.js 3 or 4, the UMD build)")
endif()
set(page ${CMAKE_CURRENT_BINARY_DIR}/report_page.cpp)
set(page_folder ${CMAKE_CURRENT_SOURCE_DIR}/commands/compare/report)
set(page_licence ${PROJECT_SOURCE_DIR}/THIRD_PARTY/chart.js.txt)
file(GLOB page_parts CONFIGURE_DEPENDS ${page_folder}/*)
add_custom_command(OUTPUT ${page} VERBATIM
    COMMAND ${CMAKE_COMMAND} -D FOLDER=${page_folder} -D CHART_JS=${LUCERNA_CHART_JS}
            -D LICENCE=${page_licence} -D OUTPUT=${page} -P ${page_folder}/embed.cmake
    DEPENDS ${page_parts} ${LUCERNA_CHART_JS} ${page_licence}
            ${CMAKE_CURRENT_SOURCE_DIR}/embed_text.cmake
    COMMENT "Putting the page of `lucerna compare` together")
target_sources(plugin_commands_compare PRIVATE ${page})
