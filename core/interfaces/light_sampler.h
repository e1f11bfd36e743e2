// SPDX-License-Identifier: Apache-2.0
/// Which lights to sample from a point, and with what probability.
///
/// Unbiasedness: the sum over all draws of contribution / pmf estimates the sum over all lights of
/// their contributions. So each light that can contribute has pmf > 0.
#pragma once

#include "core/interfaces/emitter.h"
#include "core/plugin/plugin.h"

#include <optional>
#include <span>

namespace lucerna {

struct LightChoice {
    std::uint32_t light = 0;  ///< index into Scene::lights()
    float pmf = 0;            ///< expected number of times that this light is drawn at this point
};

/// A draw that is asked for, and what came of it.
struct LightQuery {
    const Receiver* at = nullptr;
    float u = 0;                          ///< in [0, 1)
    std::optional<LightChoice> choice{};  ///< empty: none
};

class LightSampler : public Object {
public:
    static constexpr const char* kind = "light_sampler";
    ~LightSampler() override;

    /// Number of draws at each point; 0 if the scene has no light.
    virtual std::uint32_t draws() const = 0;
    /// Draw number `draw` < draws() for u in [0, 1). Empty: this draw chose no light.
    virtual std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                              float u) const = 0;
    /// Draw number `draw` at many points: the same as `sample` for each. Samplers that read much
    /// memory let the waits for it overlap.
    virtual void sample_batch(std::uint32_t draw, std::span<LightQuery> queries) const;
    /// Expected number of times that `light` is drawn at this point, over all draws: exactly what
    /// `sample` reports for it. A probability if there is one draw.
    virtual float pmf(const Receiver& at, std::uint32_t light) const = 0;

    /// Memory of the tables that it keeps [bytes]; 0 if it has none.
    virtual std::size_t bytes() const { return 0; }
};

}  // namespace lucerna
