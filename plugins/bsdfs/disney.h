// SPDX-License-Identifier: Apache-2.0
/// Formulas that `principled` and `principledthin` share.
///
/// [2012] Burley, "Physically Based Shading at Disney"; [2015] Burley, "Extending the Disney BRDF
/// to a BSDF with Integrated Subsurface Scattering". Where the papers leave a choice, it is that of
/// Mitsuba 3.
#pragma once

#include "core/interfaces/texture.h"
#include "core/math/fresnel.h"
#include "core/math/microfacet.h"

namespace lucerna::disney {

/// (1 − cos θ)⁵ of Schlick's approximation.
inline float schlick_weight(float cos_theta) {
    const float m = std::clamp(1 - cos_theta, 0.0f, 1.0f);
    return sqr(sqr(m)) * m;
}

/// Reflectance by Schlick's approximation for light from outside; if the inside is thinner, with
/// the angle on that side, which makes total internal reflection 1 ([2015], appendix B).
inline Color schlick(Color normal_incidence, float cos_theta, float eta) {
    if (eta < 1) {
        const double cos2 = cos2_transmitted(static_cast<double>(cos_theta), eta);
        cos_theta = static_cast<float>(safe_sqrt(cos2));
    }
    return glm::mix(normal_incidence, Color(1), schlick_weight(cos_theta));
}

/// The hue and saturation of a colour, with luminance 1; white for black.
inline Color tint(Color base) {
    const float y = luminance(base);
    return y > 0 ? base / y : Color(1);
}

/// Roughness² as the width of the facets' slopes, stretched along the tangent ([2012], 5.4).
inline Microfacet facets(float roughness, float anisotropic) {
    constexpr float narrowest = 0.001f;
    const float alpha = sqr(roughness), aspect = std::sqrt(1 - 0.9f * anisotropic);
    return {Microfacet::Type::ggx, std::max(narrowest, alpha / aspect),
            std::max(narrowest, alpha * aspect)};
}

/// D G / (4 cos θo cos θi) with the masking of both directions taken as independent.
inline float mirror_value(const Microfacet& facets, Vector3 m, Vector3 wo, Vector3 wi) {
    return 0.25f * facets.D(m) / (facets.visible_area(wo) * facets.visible_area(wi));
}
/// Density of the mirror direction at a visible normal [1/sr].
inline float mirror_pdf(const Microfacet& facets, Vector3 m, Vector3 wo) {
    return 0.25f * facets.D(m) / facets.visible_area(wo);
}

/// The matte lobe over ρ / π: retro-reflection at grazing angles by roughness ([2012], 5.3), and
/// with `flatness` a look of scattering below the surface ([2015], 3 and 4).
inline float matte(float roughness, float flatness, float cos_o, float cos_i, float cos_d) {
    const float o = schlick_weight(cos_o), i = schlick_weight(cos_i);
    const float retro = 2 * roughness * sqr(cos_d);
    const float base = (1 - 0.5f * o) * (1 - 0.5f * i) + retro * (o + i + o * i * (retro - 1));
    if (flatness == 0) return base;
    const float ss90 = 0.5f * retro;
    const float ss = glm::mix(1.0f, ss90, o) * glm::mix(1.0f, ss90, i);
    const float flat = 1.25f * (ss * (1 / (cos_o + cos_i) - 0.5f) + 0.5f);
    return glm::mix(base, flat, flatness);
}

/// Parameters of the lobes that both materials have.
struct Surface {
    explicit Surface(const Params& params)
        : base_color(params.color_input("base_color", Color(0.5f), unit_interval,
                                        "colour of the material")),
          roughness(part(params, "roughness", 0.5f, "roughness of the main highlight")),
          anisotropic(part(params, "anisotropic", 0, "stretch of the highlight; 0: round")),
          spec_trans(part(params, "spec_trans", 0, "how much of the material is like glass")),
          spec_tint(part(params, "spec_tint", 0, "how much the highlight has the base colour")),
          sheen(part(params, "sheen", 0, "strength of the sheen at grazing angles, as of cloth")),
          sheen_tint(part(params, "sheen_tint", 0, "how much the sheen has the base colour")),
          flatness(part(params, "flatness", 0, "how much light seems to scatter below")) {}

    static FloatInput part(const Params& params, const char* name, float value, const char* doc) {
        return params.float_input(name, value, unit_interval, doc);
    }
    /// How often a lobe is sampled, in proportion to the others.
    static float rate(const Params& params, const char* name, const char* lobe) {
        return params.real(name, 1, positive,
                           std::string("how often the ") + lobe + " is sampled; a weight");
    }
    /// True if the number can be other than zero somewhere.
    static bool used(const FloatInput& input) { return input.texture || input.constant > 0; }

    Microfacet facets_at(const Interaction& at, float scale = 1) const {
        return facets(scale * roughness(at), anisotropic(at));
    }

    /// Matte lobe for light at the angle θd to the half vector [1/sr].
    Color matte_value(const Interaction& at, Color base, Vector3 wo, Vector3 wi,
                      float cos_d) const {
        return base * (inv_pi * matte(roughness(at), flatness(at), wo.z, wi.z, cos_d));
    }

    /// Sheen ([2012], 5.6) [1/sr].
    Color sheen_value(const Interaction& at, Color base, float cos_d) const {
        const float amount = sheen(at);
        if (amount == 0) return Color(0);
        const Color hue = glm::mix(Color(1), tint(base), sheen_tint(at));
        return hue * (amount * schlick_weight(cos_d));
    }

    /// Reflectance of the highlight, from a dielectric's to one with the hue of the base.
    Color tinted(const Interaction& at, Color base, float cos_theta, float eta) const {
        const Color plain(fresnel_dielectric(cos_theta, eta));
        const float amount = spec_tint(at);
        if (amount == 0) return plain;
        const Color normal_incidence = tint(base) * sqr((eta - 1) / (eta + 1));
        return glm::mix(plain, schlick(normal_incidence, cos_theta, eta), amount);
    }

    ColorInput base_color;
    FloatInput roughness, anisotropic, spec_trans, spec_tint, sheen, sheen_tint, flatness;
};

}  // namespace lucerna::disney
