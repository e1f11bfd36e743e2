// SPDX-License-Identifier: Apache-2.0
/// What smooth and rough dielectrics share: two colours, and the two ways light can go.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/math/fresnel.h"

namespace lucerna {

/// Light is reflected, or refracted into what lies behind; η is inside over outside.
struct Glass {
    explicit Glass(const Params& params, float relative_eta)
        : eta(relative_eta),
          reflectance(params.color_input("specular_reflectance", Color(1), unit_interval,
                                         "factor of reflected light; 1 is physical")),
          transmittance(params.color_input("specular_transmittance", Color(1), unit_interval,
                                           "factor of transmitted light; 1 is physical")) {}

    /// Factor of refracted light: radiance is spread over a larger or smaller solid angle
    /// (Veach 1997, 5.2); `there` is the index of refraction along wi over that along wo.
    Color transmitted(const Interaction& at, float there, TransportMode mode) const {
        return transmittance(at) * (mode == TransportMode::radiance ? 1 / sqr(there) : 1.0f);
    }

    Color albedo(const Interaction& at, float cos_theta) const {
        const float reflected = fresnel_dielectric(cos_theta, eta);
        return reflectance(at) * reflected + transmittance(at) * (1 - reflected);
    }

    /// The same substance on both sides: light goes straight through.
    bool matched() const { return eta == 1; }
    /// The fraction of light that does so.
    Color straight(const Interaction& at) const { return matched() ? transmittance(at) : Color(0); }

    /// A perfectly smooth surface: reflection with probability F, else refraction.
    std::optional<BSDFSample> sample_smooth(const Interaction& at, Vector3 wo, float u_lobe,
                                            TransportMode mode) const {
        if (wo.z == 0) return {};
        const float reflected = fresnel_dielectric(wo.z, eta);
        if (u_lobe < reflected) {
            return BSDFSample{.wi = reflect(wo),
                              .weight = reflectance(at),
                              .pdf = reflected,
                              .lobe = Lobe::specular_reflection};
        }
        const std::optional<Refraction> refracted = refract(wo, Vector3(0, 0, 1), eta);
        if (!refracted) return {};
        return BSDFSample{.wi = refracted->direction,
                          .weight = transmitted(at, refracted->eta, mode),
                          .pdf = 1 - reflected,
                          .lobe = matched() ? Lobe::null : Lobe::specular_transmission,
                          .eta = refracted->eta};
    }

    float eta;
    ColorInput reflectance, transmittance;
};

}  // namespace lucerna
