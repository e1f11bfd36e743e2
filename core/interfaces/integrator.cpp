// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/integrator.h"

#include "core/render/render_job.h"

namespace lucerna {

Integrator::~Integrator() = default;
SamplingIntegrator::~SamplingIntegrator() = default;

void SamplingIntegrator::render(RenderJob& job) const {
    job.render_samples([&](const Ray& ray, SampleStream& stream, PixelSample& result) {
        sample(job.scene(), ray, stream, result);
    });
}

}  // namespace lucerna
