// SPDX-License-Identifier: Apache-2.0
/// Lights for many points at once: see bsdf_batch.h. T may have functions `at_many` and
/// `sample_many`, in which samplers that read much memory let the waits for it overlap.
#pragma once

#include "core/interfaces/light_distribution.h"

#include <span>

namespace lucerna {

class LightSampler;

/// A draw that is asked for, and what came of it.
struct LightDraw {
    const LightDistribution* lights = nullptr;
    double u = 0;                         ///< in [0, 1)
    std::optional<LightChoice> choice{};  ///< empty: none
};

struct LightSamplerBatch {
    /// As LightSampler::at, for each receiver.
    void (*at)(const LightSampler& sampler, std::span<const Receiver* const> receivers,
               std::span<LightDistribution* const> out);
    /// As LightDistribution::sample, for distributions of this sampler.
    void (*sample)(const LightSampler& sampler, std::span<LightDraw> draws);

    template <typename T>
    static void attach(T& object) {
        static constexpr LightSamplerBatch loops{.at = at_each<T>, .sample = sample_each<T>};
        object.batch_ = &loops;
    }

private:
    template <typename T>
    static void at_each(const LightSampler& sampler, std::span<const Receiver* const> receivers,
                        std::span<LightDistribution* const> out) {
        const T& it = static_cast<const T&>(sampler);
        if constexpr (requires { it.at_many(receivers, out); }) {
            it.at_many(receivers, out);
        } else {
            for (std::size_t i = 0; i < receivers.size(); ++i) out[i]->set(it.at(*receivers[i]));
        }
    }

    template <typename T>
    static void sample_each(const LightSampler& sampler, std::span<LightDraw> draws) {
        const T& it = static_cast<const T&>(sampler);
        if constexpr (requires { it.sample_many(draws); }) {
            it.sample_many(draws);
        } else {
            using Distribution = decltype(it.at(std::declval<const Receiver&>()));
            for (LightDraw& draw : draws) {
                draw.choice = draw.lights->get<Distribution>().sample(draw.u);
            }
        }
    }
};

}  // namespace lucerna
