// SPDX-License-Identifier: Apache-2.0
/// Light samplers by the names that benchmarks take on their command lines: a type, and parameters
/// after it, such as cache:lights=128:jitter=0.5.
#pragma once

#include "tests/benchmarks/benchmark_scenes.h"
#include "tests/prepared_sampler.h"

namespace lucerna {

/// The XML of "cache:lights=128".
inline std::string element_of(const std::string& text) {
    std::vector<std::string> words{""};
    for (const char c : text) {
        if (c == ':') {
            words.emplace_back();
        } else {
            words.back() += c;
        }
    }
    std::string xml = "<light_sampler type='" + words.front() + "'>";
    for (std::size_t i = 1; i < words.size(); ++i) {
        const std::size_t equals = words[i].find('=');
        const std::string value = words[i].substr(equals + 1);
        const bool letters = value.find_first_not_of("0123456789.-") != std::string::npos;
        const char* type = value == "true" || value == "false"    ? "boolean"
                           : letters                              ? "string"
                           : value.find('.') == std::string::npos ? "integer"
                                                                  : "float";
        xml += fmt::format("<{} name='{}' value='{}'/>", type, words[i].substr(0, equals), value);
    }
    return xml + "</light_sampler>";
}

}  // namespace lucerna
