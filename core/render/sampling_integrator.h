// SPDX-License-Identifier: Apache-2.0
/// Integrators that see one camera ray at a time, and leave passes and budgets to the job.
#pragma once

#include "core/interfaces/integrator.h"

namespace lucerna {

class Scene;

/// An integrator that estimates radiance along camera rays.
class SamplingIntegrator : public Integrator {
public:
    ~SamplingIntegrator() override;

    /// Passes over all pixels until the budget is spent.
    void render(RenderJob& job) const final;

    /// Fills the results of some samples, whole blocks of them. What a sample gets depends on its
    /// block alone. Called from many threads.
    virtual void sample(const Scene& scene, std::span<CameraSample> samples) const = 0;
};

}  // namespace lucerna
