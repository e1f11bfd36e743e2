// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/integrator.h"

#include "core/render/render_job.h"

namespace lucerna {

Integrator::~Integrator() = default;
SamplingIntegrator::~SamplingIntegrator() = default;

void SamplingIntegrator::render(RenderJob& job) const {
    job.render_batches([&](std::span<CameraSample> samples) { sample_batch(job.scene(), samples); },
                       batch_size());
}

void SamplingIntegrator::sample_batch(const Scene& scene, std::span<CameraSample> samples) const {
    for (CameraSample& s : samples) sample(scene, s.ray, s.stream, s.result);
}

}  // namespace lucerna
