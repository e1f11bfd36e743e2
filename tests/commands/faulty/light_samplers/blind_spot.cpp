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
    std::uint32_t draws() const override { return count_ > 0 ? 1 : 0; }

    std::optional<LightChoice> sample(const Receiver& at, std::uint32_t, float u) const override {
        const std::uint32_t first = first_at(at), left = count_ - first;
        const auto place = static_cast<std::uint32_t>(u * static_cast<float>(left));
        const std::uint32_t light = first + std::min(place, left - 1);
        return LightChoice{.light = light, .pmf = pmf(at, light)};
    }
    float pmf(const Receiver& at, std::uint32_t light) const override {
        const std::uint32_t first = first_at(at);
        return light < first ? 0 : 1 / static_cast<float>(count_ - first);
    }

private:
    std::uint32_t first_at(const Receiver& at) const { return at.p.x > 0 ? count_ / 2 : 0; }

    std::uint32_t count_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<BlindSpot>("never draws some lights at some points");

}  // namespace lucerna
