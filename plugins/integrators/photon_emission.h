// SPDX-License-Identifier: Apache-2.0
/// Which light a photon leaves.
#pragma once

#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

/// Shares photons among the lights by systematic sampling: of n photons each light with the
/// fraction p of the power emits ⌊n p⌋ or ⌈n p⌉, n p on average. They are numbered light by light.
class PhotonEmission {
public:
    explicit PhotonEmission(const Scene& scene) {
        double total = 0;
        cdf_.reserve(scene.lights().size() + 1);
        cdf_.push_back(0);
        for (const Light& light : scene.lights()) {
            total += light.emitter->bounds(light).power;
            cdf_.push_back(total);
        }
        for (double& x : cdf_) x = total > 0 ? x / total : 0;
        // Rounding must not give a photon to lights without power that come last.
        while (cdf_.size() > 1 && cdf_[cdf_.size() - 2] == cdf_.back()) cdf_.pop_back();
    }

    /// No light has power.
    bool dark() const { return cdf_.size() == 1; }

    struct Choice {
        std::uint32_t light;
        double pmf;           ///< expected share of the photons
        std::uint64_t index;  ///< of the photon among those of its light
        std::uint64_t left;   ///< photons that the light has still to emit, with this one
    };
    /// For photon j of `count`; `offset` in [0, 1) is the same for all of them.
    Choice choose(std::uint64_t j, std::uint64_t count, double offset) const {
        const auto first = [&](double cdf) {
            const double at = cdf * static_cast<double>(count) - offset;
            return at > 0 ? static_cast<std::uint64_t>(std::ceil(at)) : 0;
        };
        const auto next = std::partition_point(cdf_.begin() + 1, cdf_.end() - 1,
                                               [&](double cdf) { return first(cdf) <= j; });
        const double begin = *(next - 1), end = *next;
        return {.light = static_cast<std::uint32_t>(next - cdf_.begin() - 1),
                .pmf = end - begin,
                .index = j - first(begin),
                .left = (next == cdf_.end() - 1 ? count : first(end)) - j};
    }

private:
    std::vector<double> cdf_;  ///< before each light, and after the last that has power
};

}  // namespace lucerna
