// SPDX-License-Identifier: Apache-2.0
/// A sample of smooth lobes from a drawn direction.
#pragma once

#include "core/interfaces/bsdf.h"

namespace lucerna {

/// Value and density come from `bsdf.evaluate`, so that the three functions agree whatever was
/// rounded on the way to `wi`. Empty where evaluate says that `wi` cannot be drawn.
inline std::optional<BSDFSample> drawn(const BSDF& bsdf, const Interaction& at, Vector3 wo,
                                       Vector3 wi, TransportMode mode, Lobe lobe, float eta = 1) {
    const BSDFValue value = bsdf.evaluate(at, wo, wi, mode);
    if (!(value.pdf > 0)) return {};
    return BSDFSample{.wi = wi,
                      .weight = value.f * (abs_cos_theta(wi) / value.pdf),
                      .pdf = value.pdf,
                      .lobe = lobe,
                      .eta = eta};
}

/// Maps `u` of [begin, end) back to [0, 1): one random number chooses a lobe and then serves it.
inline float rescaled(float u, float begin, float end) {
    return std::min((u - begin) / (end - begin), one_minus_epsilon);
}

}  // namespace lucerna
