// SPDX-License-Identifier: Apache-2.0
/// Which lights to sample from a point, and with what probability.
///
/// Unbiasedness: the sum over all draws of contribution / pmf estimates the sum over all lights of
/// their contributions. So each light that can contribute has pmf > 0.
#pragma once

#include "core/interfaces/batch/light_sampler_batch.h"
#include "core/interfaces/emitter.h"
#include "core/plugin/plugin.h"

#include <optional>

namespace lucerna {

class LightSampler : public Object {
public:
    static constexpr const char* kind = "light_sampler";
    ~LightSampler() override;

    /// Number of draws at each point; 0 if the scene has no light.
    virtual std::uint32_t draws() const = 0;
    /// Draw number `draw` < draws() for u in [0, 1). Empty: this draw chose no light.
    virtual std::optional<LightChoice> sample(const Receiver& at, std::uint32_t draw,
                                              float u) const = 0;
    /// Expected number of times that `light` is drawn at this point, over all draws: exactly what
    /// `sample` reports for it. A probability if there is one draw.
    virtual float pmf(const Receiver& at, std::uint32_t light) const = 0;

    /// Memory of the tables that it keeps [bytes]; 0 if it has none.
    virtual std::size_t bytes() const { return 0; }

    /// The functions above for many at once: made by `describe`.
    using Batch = LightSamplerBatch;
    const Batch& batch() const { return *batch_; }

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

}  // namespace lucerna
