// SPDX-License-Identifier: Apache-2.0
/// Estimates one over its probabilities, and never chooses the first light, which it says it does.
#include "core/scene/scene.h"

namespace lucerna {
namespace {

class LostLight final : public LightSampler {
public:
    explicit LostLight(const Params&) {}

    void prepare(const Scene& scene) override {
        count_ = static_cast<std::uint32_t>(scene.lights().size());
    }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const {
            const auto light = static_cast<std::uint32_t>(u * count);
            if (light == 0 || light >= count) return {};
            const double second = u * count - light;  // of mean 1: 0.5 or 1.5
            const auto n = static_cast<float>(count);
            return LightChoice{
                .light = light, .pmf = 1 / n, .weight = second < 0.5 ? n / 2 : 1.5f * n};
        }
        float pmf(std::uint32_t) const { return 1 / static_cast<float>(count); }
        std::uint32_t count;
    };
    Distribution at(const Receiver&) const { return {count_}; }

private:
    std::uint32_t count_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<LostLight>("never chooses the first light");

}  // namespace lucerna
