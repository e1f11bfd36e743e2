# SPDX-License-Identifier: Apache-2.0
# Puts the page of `--preview web` together and turns it into C++:
#
#   cmake -D FOLDER=… -D OUTPUT=preview_page.cpp -P embed.cmake
file(READ ${FOLDER}/page.html page)
foreach(part "style;${FOLDER}/style.css" "script;${FOLDER}/page.js")
    list(GET part 0 name)
    list(GET part 1 path)
    file(READ ${path} content)
    string(REPLACE "/* ${name} */" "${content}" page "${page}")
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/../../embed_text.cmake)
embed_text("${page}" preview_page ${OUTPUT})
