// SPDX-License-Identifier: Apache-2.0
/// Light samplers by the names that benchmarks take on their command lines: a type, and parameters
/// after it, such as cache:lights=128:jitter=0.5.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/scene/builder.h"
#include "core/scene/xml_reader.h"
#include "tests/benchmarks/benchmark_scenes.h"

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

/// A sampler of such a name, ready for a scene.
class BuiltSampler {
public:
    BuiltSampler(const std::string& name, const Scene& scene) {
        Diagnostics diagnostics;
        const Description description =
            read_scene_text("<scene version='3.0.0'>" + element_of(name) + "</scene>",
                            "sampler.xml", {}, diagnostics);
        build_object(*description.root->children.front().element, description, registry_,
                     diagnostics, objects_);
        diagnostics.throw_if_errors();
        objects_.back()->prepare(scene);
    }
    const LightSampler& operator*() const {
        return static_cast<const LightSampler&>(*objects_.back());
    }

private:
    Registry registry_;
    std::vector<std::unique_ptr<Object>> objects_;
};

}  // namespace lucerna
