// SPDX-License-Identifier: Apache-2.0
/// Lights for many points at once: see bsdf_batch.h. T may have a function `sample_many`, in which
/// samplers that read much memory let the waits for it overlap.
#pragma once

#include "core/interfaces/light.h"

#include <optional>
#include <span>

namespace lucerna {

class LightSampler;

/// A draw that is asked for, and what came of it.
struct LightQuery {
    const Receiver* at = nullptr;
    float u = 0;                          ///< in [0, 1)
    std::optional<LightChoice> choice{};  ///< empty: none
};

struct LightSamplerBatch {
    /// As LightSampler::sample, draw number `draw` for each query.
    void (*sample)(const LightSampler& sampler, std::uint32_t draw, std::span<LightQuery> queries);

    template <typename T>
    static void attach(T& object) {
        static constexpr LightSamplerBatch loops{.sample = sample_each<T>};
        object.batch_ = &loops;
    }

private:
    template <typename T>
    static void sample_each(const LightSampler& sampler, std::uint32_t draw,
                            std::span<LightQuery> queries) {
        const T& it = static_cast<const T&>(sampler);
        if constexpr (requires { it.sample_many(draw, queries); }) {
            it.sample_many(draw, queries);
        } else {
            for (LightQuery& query : queries) query.choice = it.sample(*query.at, draw, query.u);
        }
    }
};

}  // namespace lucerna
