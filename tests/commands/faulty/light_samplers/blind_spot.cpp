// SPDX-License-Identifier: Apache-2.0
/// Chooses every light with the same probability, but never the first half of them at points with
/// x > 0: what they light there stays dark.
#include "core/scene/scene.h"

namespace lucerna {
namespace {

class BlindSpot final : public LightSampler {
public:
    explicit BlindSpot(const Params&) {}

    void prepare(const Scene& scene) override {
        count_ = static_cast<std::uint32_t>(scene.lights().size());
    }

    struct Distribution {
        std::optional<LightChoice> sample(double u) const {
            if (first >= end) return {};
            const auto place = static_cast<std::uint32_t>(u * (end - first));
            const std::uint32_t light = std::min(first + place, end - 1);
            return LightChoice{.light = light, .pmf = pmf(light)};
        }
        float pmf(std::uint32_t light) const {
            return light < first ? 0 : 1 / static_cast<float>(end - first);
        }
        std::uint32_t first, end;
    };
    Distribution at(const Receiver& receiver) const {
        return {receiver.p.x > 0 ? count_ / 2 : 0, count_};
    }

private:
    std::uint32_t count_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<BlindSpot>("never draws some lights at some points");

}  // namespace lucerna
