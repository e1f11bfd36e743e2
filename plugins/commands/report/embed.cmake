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

file(WRITE ${OUTPUT}.html "${page}")
file(READ ${OUTPUT}.html bytes HEX)
file(REMOVE ${OUTPUT}.html)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
string(REPEAT "." 120 line)  # 24 numbers
string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <cstddef>

namespace lucerna {
extern const unsigned char report_page[];
extern const std::size_t report_page_size;
const unsigned char report_page[] = {
${bytes}
};
const std::size_t report_page_size = sizeof report_page;
}  // namespace lucerna
")
