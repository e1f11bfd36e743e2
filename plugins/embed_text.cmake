# SPDX-License-Identifier: Apache-2.0
# embed_text(TEXT NAME OUTPUT): a C++ file that defines the bytes of a text, `lucerna::NAME`, and
# their number, `lucerna::NAME_size`.
function(embed_text text name output)
    file(WRITE ${output}.text "${text}")
    file(READ ${output}.text bytes HEX)
    file(REMOVE ${output}.text)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(REPEAT "." 120 line)  # 24 numbers
    string(REGEX REPLACE "(${line})" "\\1\n" bytes "${bytes}")
    file(WRITE ${output} "#include <cstddef>

namespace lucerna {
extern const unsigned char ${name}[];
extern const std::size_t ${name}_size;
const unsigned char ${name}[] = {
${bytes}
};
const std::size_t ${name}_size = sizeof ${name};
}  // namespace lucerna
")
endfunction()

# embed_page(FOLDER NAME OUTPUT PART=PATH …): the same for page.html of a folder, in which the
# content of each PATH takes the place of the comment /* PART */.
function(embed_page folder name output)
    file(READ ${folder}/page.html page)
    foreach(part IN LISTS ARGN)
        string(REPLACE "=" ";" part "${part}")
        list(GET part 0 key)
        list(GET part 1 path)
        file(READ ${path} content)
        string(REPLACE "/* ${key} */" "${content}" page "${page}")
    endforeach()
    embed_text("${page}" ${name} ${output})
endfunction()
