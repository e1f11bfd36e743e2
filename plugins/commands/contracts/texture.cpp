// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/texture.h"

#include <fmt/format.h>

namespace lucerna::contracts {

namespace {

std::string text(Vector2 v) { return fmt::format("({:.6g}, {:.6g})", v.x, v.y); }
std::string text(Color c) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", c.x, c.y, c.z); }

}  // namespace

Evidence texture_values(const Texture& texture, const Effort& effort) {
    Evidence evidence("values are finite and below max()");
    Rng rng(hash64({effort.seed, 2}));
    for (int i = 0; i < effort.part(100); ++i) {
        const Vector2 uv = 6.0f * rng.next_float2() - 2.0f;
        const Color color = texture.color(uv);
        const float real = texture.real(uv);
        evidence.require(is_finite(color) && std::isfinite(real), [&] {
            return fmt::format("color {}, real {} at {}", text(color), real, text(uv));
        });
        evidence.require(max_component(color) <= texture.max() + 1e-5f, [&] {
            return fmt::format("color {} at {}, max() {}", text(color), text(uv), texture.max());
        });
        const float expected = luminance(color);
        evidence.require(std::abs(real - expected) <= 1e-4f * (1 + std::abs(expected)), [&] {
            return fmt::format("real {} at {}, luminance {}", real, text(uv), expected);
        });
    }
    return evidence;
}

Evidence texture_mean(const Texture& texture, const Effort& effort) {
    Evidence evidence("mean() is the average");
    // Lattices that are moved at random: each gives an unbiased and nearly exact average.
    constexpr int lattices = 32;
    const int side = std::max(static_cast<int>(std::sqrt(effort.samples / lattices)), 16);
    Rng rng(hash64({effort.seed, 3}));
    RunningStatistics means[3];
    for (int k = 0; k < lattices; ++k) {
        const Vector2 shift = rng.next_float2();
        ColorD sum(0);
        for (int i = 0; i < side * side; ++i) {
            const Vector2 cell(static_cast<float>(i % side), static_cast<float>(i / side));
            sum += ColorD(texture.color((cell + shift) / static_cast<float>(side)));
        }
        for (int c = 0; c < 3; ++c) means[c].add(sum[c] / (side * side));
    }
    const Color mean = texture.mean();
    for (int c = 0; c < 3; ++c) {
        const double told = static_cast<double>(mean[c]);
        evidence.test(mean_is(means[c], told, 1e-5 * (1 + std::abs(told))),
                      fmt::format("in channel {}", c));
    }
    return evidence;
}

Evidence texture_gradient(const Texture& texture, const Effort& effort) {
    Evidence evidence("gradient is that of the values");
    Rng rng(hash64({effort.seed, 4}));
    for (int i = 0; i < effort.part(400); ++i) {
        const Vector2 uv = 3.0f * rng.next_float2() - 1.0f;
        const auto slope = [&](float h) {
            return Vector2(texture.real(uv + Vector2(h, 0)) - texture.real(uv),
                           texture.real(uv + Vector2(0, h)) - texture.real(uv)) /
                   h;
        };
        const auto central = [&](float h) { return 0.5f * (slope(h) + slope(-h)); };
        const auto bend = [&](float h) { return (slope(h) - slope(-h)) / h; };
        // At an edge, these change with the step.
        constexpr float h = 0x1p-9f;
        const Vector2 middle = central(h / 2);
        const float size = 1 + glm::length(middle);
        if (glm::distance(central(h), middle) > 1e-3f * size) continue;
        if (glm::distance(bend(h), bend(h / 2)) * h > 2e-2f * size) continue;
        const Vector2 gradient = texture.gradient(uv);
        evidence.require(glm::distance(gradient, middle) < 4e-3f * size, [&] {
            return fmt::format("{} at {}, not {}", text(gradient), text(uv), text(middle));
        });
    }
    return evidence;
}

Evidence texture_extreme_coordinates(const Texture& texture) {
    Evidence evidence("extreme coordinates are harmless");
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float x : {-1e-10f, 1.0f, 1e10f, -1e30f, infinity, -infinity, nan}) {
        for (const Vector2 uv : {Vector2(x, 0.3f), Vector2(0.3f, x), Vector2(x, x)}) {
            const bool sound = is_finite(texture.color(uv)) && std::isfinite(texture.real(uv)) &&
                               std::isfinite(texture.gradient(uv).x) &&
                               std::isfinite(texture.gradient(uv).y);
            evidence.require(sound, [&] { return "not finite at " + text(uv); });
        }
    }
    return evidence;
}

std::vector<Evidence> check(const Texture& texture, const Effort& effort) {
    return {texture_values(texture, effort), texture_mean(texture, effort),
            texture_gradient(texture, effort), texture_extreme_coordinates(texture)};
}

}  // namespace lucerna::contracts
