// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/bsdf.h"

namespace lucerna {

BSDF::~BSDF() = default;

void BSDF::sample_lanes(std::span<const Interaction* const> at, const Vector3Lanes& wo,
                        const FloatLanes& u_lobe, const Vector2Lanes& u, TransportMode mode,
                        BSDFSampleLanes& out) const {
    for (std::size_t i = 0; i < at.size(); ++i) {
        const std::optional<BSDFSample> one = sample(*at[i], wo[i], u_lobe[i], u[i], mode);
        out.lobe[i] = one ? one->lobe : Lobe::none;
        if (!one) continue;
        out.wi.set(i, one->wi);
        out.weight.set(i, one->weight);
    }
}

}  // namespace lucerna
