// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a scene or end in error messages. Lines at the end that begin with "-D " or
/// "--set " are options.
#include "core/description/xml_reader.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace {

/// Takes options from the end of the text.
lucerna::ReadOptions take_options(std::string& text) {
    lucerna::ReadOptions options;
    options.limits.max_bytes = 1 << 20;
    options.limits.max_elements = 10'000;
    for (int i = 0; i < 4; ++i) {
        const std::size_t line = text.rfind('\n');
        if (line == std::string::npos) break;
        const std::string last = text.substr(line + 1);
        const std::size_t equals = last.find('=');
        if (last.starts_with("--set ")) {
            options.overrides.push_back(last.substr(6));
        } else if (last.starts_with("-D ") && equals != std::string::npos) {
            options.defines.emplace_back(last.substr(3, equals - 3), last.substr(equals + 1));
        } else {
            break;
        }
        text.resize(line);
    }
    return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string text(reinterpret_cast<const char*>(data), size);
    const lucerna::ReadOptions options = take_options(text);
    lucerna::Diagnostics diagnostics;
    const lucerna::Description description =
        lucerna::read_scene_text(text, "fuzz.xml", options, diagnostics);
    // A scene without errors is complete; messages can be written in any case.
    for (const lucerna::Diagnostic& d : diagnostics.all()) {
        if (d.message.empty() || d.text().empty()) std::abort();
    }
    if (diagnostics.error_count() > 0) return 0;
    for (const lucerna::Element& element : description.elements) {
        for (const lucerna::Child& child : element.children) {
            if (!child.element) std::abort();
        }
    }
    if (lucerna::hash_of(description) != description.hash) std::abort();
    return 0;
}
