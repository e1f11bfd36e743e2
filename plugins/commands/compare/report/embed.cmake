# SPDX-License-Identifier: Apache-2.0
# Puts the page of `lucerna compare` together and turns it into C++, so that the program needs no
# files at run time and the page no network:
#
#   cmake -D FOLDER=… -D CHART_JS=… -D LICENCE=… -D OUTPUT=report_page.cpp -P embed.cmake
include(${CMAKE_CURRENT_LIST_DIR}/../../../embed_text.cmake)
embed_page(${FOLDER} report_page ${OUTPUT}
    style=${FOLDER}/style.css
    chart=${CHART_JS}
    licence=${LICENCE}
    pictures=${FOLDER}/pictures.js
    figures=${FOLDER}/figures.js
    viewer=${FOLDER}/viewer.js)
