# SPDX-License-Identifier: Apache-2.0
# Puts the page of `lucerna compare` together and turns it into C++, so that the program needs no
# files at run time and the page no network:
#
#   cmake -D FOLDER=… -D CHART_JS=… -D LICENCE=… -D OUTPUT=report_page.cpp -P embed.cmake
file(READ ${FOLDER}/page.html page)
foreach(part "style;${FOLDER}/style.css" "chart;${CHART_JS}" "licence;${LICENCE}"
             "pictures;${FOLDER}/pictures.js" "figures;${FOLDER}/figures.js"
             "viewer;${FOLDER}/viewer.js")
    list(GET part 0 name)
    list(GET part 1 path)
    file(READ ${path} content)
    string(REPLACE "/* ${name} */" "${content}" page "${page}")
endforeach()

include(${CMAKE_CURRENT_LIST_DIR}/../../embed_text.cmake)
embed_text("${page}" report_page ${OUTPUT})
