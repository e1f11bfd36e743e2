// SPDX-License-Identifier: Apache-2.0
/// The patches of an environment map, as a partition of its picture.
#include "plugins/emitters/map_patches.h"

#include "core/math/sequences.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

std::vector<float> weights(int width, int height) {
    Rng rng(9);
    std::vector<float> result;
    for (int i = 0; i < width * height; ++i) {
        const float x = rng.next_float();
        result.push_back(i % 4099 == 17 ? 1000.0f : x * x);
    }
    return result;
}

TEST(MapPatches, DensityIsThatOfTheWholePicture) {
    for (const Vector2i size : {Vector2i(256, 128), Vector2i(1030, 517), Vector2i(40, 333)}) {
        const std::vector<float> w = weights(size.x, size.y);
        const MapPatches patches(w, size.x, size.y);
        const PiecewiseConstant2D whole(w, size.x, size.y);
        double total = 0;
        for (std::uint32_t i = 0; i < patches.size(); ++i) total += patches.power(i);
        EXPECT_NEAR(total, whole.total(), 1e-9 * total);
        Rng rng(1);
        for (int i = 0; i < 20000; ++i) {
            const Vector2 uv = rng.next_float2();
            const Vector2 place = uv * Vector2(size), inside = glm::abs(glm::fract(place) - 0.5f);
            if (max_component({inside, 0}) > 0.499f) continue;  // rounding chooses the texel
            const std::uint32_t patch = patches.at(uv);
            const auto share = static_cast<float>(patches.power(patch) / total);
            EXPECT_NEAR(share * patches.pdf(patch, uv), whole.pdf(uv), 1e-4f * whole.pdf(uv));
        }
    }
}

TEST(MapPatches, SamplesStayInTheirPatch) {
    const MapPatches patches(weights(1030, 517), 1030, 517);
    ASSERT_EQ(patches.size(), MapPatches::most);
    Rng rng(2);
    for (std::uint32_t i = 0; i < patches.size(); ++i) {
        for (int k = 0; k < 100; ++k) {
            const float x = rng.next_float(), y = rng.next_float();
            const auto [p, pdf] = patches.sample(i, Vector2d(x, y));
            EXPECT_EQ(patches.at(p), i);
            EXPECT_NEAR(patches.pdf(i, p), pdf, 1e-5f * pdf);
        }
    }
}

TEST(MapPatches, OnePatchForFewTiles) {
    EXPECT_EQ(MapPatches(weights(24, 24), 24, 24).size(), 1u);
    EXPECT_EQ(MapPatches(weights(1, 1), 1, 1).size(), 1u);
    EXPECT_EQ(MapPatches(weights(32, 32), 32, 32).size(), 16u);
}

}  // namespace
}  // namespace lucerna
