// SPDX-License-Identifier: Apache-2.0
/// uniform: every light with the same probability, P(l) = 1 / n. An environment map counts as one.
///
/// The simplest sampler, best for one light or a few equal ones; its variance grows with the
/// number of lights. With as many draws at a point as there are lights (or environments), each is
/// drawn once: the plain ray tracer that visits every light.
#include "plugins/light_samplers/lights/light_groups.h"

namespace lucerna {

namespace {

class UniformLightSampler final : public LightSampler {
public:
    explicit UniformLightSampler(const Params&) {}

    void prepare(const Scene& scene) override { groups_ = LightGroups(scene); }

    /// The same everywhere.
    struct Distribution {
        std::optional<LightChoice> sample(double u) const {
            if (groups->size() == 0) return {};
            const auto count = static_cast<double>(groups->size());
            const double group = std::min(std::floor(u * count), count - 1);
            return groups->draw(static_cast<std::size_t>(group), u * count - group, share());
        }
        float pmf(std::uint32_t light) const { return share() * groups->pmf(light); }
        float share() const { return 1 / static_cast<float>(groups->size()); }

        const LightGroups* groups;
    };
    Distribution at(const Receiver&) const { return {&groups_}; }

private:
    LightGroups groups_;
};

}  // namespace

const PluginInfo plugin =
    describe<UniformLightSampler>("chooses every light with the same probability");

}  // namespace lucerna
