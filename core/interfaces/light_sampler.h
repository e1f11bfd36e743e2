// SPDX-License-Identifier: Apache-2.0
/// Which lights to sample from a point, and with what probability.
///
/// A plugin's class has a function
///
///     Distribution at(const Receiver& receiver) const;
///
/// that returns an object of its own, small and without pointers to memory of its own, with two
/// functions:
///
///     std::optional<LightChoice> sample(double u) const;   // u in [0, 1); empty: no light
///     float pmf(std::uint32_t light) const;                // what `sample` reports for a light
///
/// Unbiasedness: the mean of LightChoice::weight over all draws, counted where a light is drawn, is
/// 1 for each light that can contribute. Where it is 1 / pmf, pmf is the probability of the light.
#pragma once

#include "core/interfaces/batch/light_sampler_batch.h"
#include "core/interfaces/emitter.h"
#include "core/plugin/plugin.h"

namespace lucerna {

class LightSampler : public Object {
public:
    static constexpr const char* kind = "light_sampler";
    ~LightSampler() override;

    /// The distribution at a point.
    LightDistribution at(const Receiver& receiver) const;

    /// Memory of the tables that it keeps [bytes]; 0 if it has none.
    virtual std::size_t bytes() const { return 0; }

    /// `at` and LightDistribution::sample for many at once: made by `describe`.
    using Batch = LightSamplerBatch;
    const Batch& batch() const { return *batch_; }

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

}  // namespace lucerna
