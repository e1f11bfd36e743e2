// SPDX-License-Identifier: Apache-2.0
/// A light sampler outside of an integrator, for tests and benchmarks.
#pragma once

#include "core/description/xml_reader.h"
#include "core/interfaces/light_sampler.h"
#include "core/scene/builder.h"

#include <memory>
#include <string>
#include <vector>

namespace lucerna {

inline std::string light_sampler(const std::string& type, const std::string& inside = "") {
    return "<light_sampler type='" + type + "'>" + inside + "</light_sampler>";
}

/// Names for tests that hold for all light samplers: every plugin, and "clusters", which is `cache`
/// as it works in scenes of more lights than a test has.
inline std::vector<std::string> tested_samplers() {
    std::vector<std::string> names = Registry().names(LightSampler::kind);
    names.push_back("clusters");
    return names;
}

/// The element of one of these names.
inline std::string tested_sampler(const std::string& name) {
    if (name != "clusters") return light_sampler(name);
    return light_sampler("cache", "<integer name='clusters' value='24'/>");
}

/// A light sampler from its element, such as `<light_sampler type="bvh"/>`, ready for a scene.
class PreparedSampler {
public:
    PreparedSampler(const std::string& element, const Scene& scene) {
        Diagnostics diagnostics;
        const Description description = read_scene_text(
            "<scene version='3.0.0'>" + element + "</scene>", "sampler.xml", {}, diagnostics);
        build_object(*description.root->children.front().element, description, registry_,
                     diagnostics, objects_);
        diagnostics.throw_if_errors();
        for (const auto& object : objects_) object->prepare(scene);
    }
    const LightSampler& operator*() const {
        return static_cast<const LightSampler&>(*objects_.back());
    }
    const LightSampler* operator->() const { return &**this; }

private:
    Registry registry_;
    std::vector<std::unique_ptr<Object>> objects_;
};

/// The probability of a light at a point.
inline float pmf(const LightSampler& sampler, const Receiver& at, std::uint32_t light) {
    return sampler.at(at).pmf(light);
}

}  // namespace lucerna
