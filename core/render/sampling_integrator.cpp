// SPDX-License-Identifier: Apache-2.0
#include "core/render/sampling_integrator.h"

#include "core/render/render_job.h"

namespace lucerna {

SamplingIntegrator::~SamplingIntegrator() = default;

void SamplingIntegrator::render(RenderJob& job) const {
    job.render_batches([&](std::span<CameraSample> samples) { sample(job.scene(), samples); });
}

}  // namespace lucerna
