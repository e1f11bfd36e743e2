# SPDX-License-Identifier: Apache-2.0
# Puts the page of `--preview web` together and turns it into C++:
#
#   cmake -D FOLDER=… -D OUTPUT=preview_page.cpp -P embed.cmake
include(${CMAKE_CURRENT_LIST_DIR}/../../embed_text.cmake)
embed_page(${FOLDER} preview_page ${OUTPUT}
    style=${FOLDER}/style.css
    script=${FOLDER}/page.js)
