// SPDX-License-Identifier: Apache-2.0
/// Microfacet distributions for rough surfaces.
///
/// Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014,
/// "Understanding the Masking-Shadowing Function". Directions are unit vectors in the frame of the
/// surface, pointing away from it. w may lie on either side; microfacet normals m have m.z > 0.
#pragma once

#include "core/math/frame.h"

namespace lucerna {

/// A distribution of normals with Smith masking. All functions are finite for every direction,
/// also in the plane of the surface.
struct Microfacet {
    enum class Type {
        /// Gaussian slopes.
        beckmann,
        /// Trowbridge and Reitz 1975, called GGX by Walter et al.
        ggx
    };

    /// Widths below this are clamped: there a float cannot tell facet from surface.
    static constexpr float min_alpha = 1e-4f;

    Microfacet(Type type_, float alpha_x_, float alpha_y_)
        : type(type_),
          alpha_x(std::max(alpha_x_, min_alpha)),
          alpha_y(std::max(alpha_y_, min_alpha)) {}

    /// True if the surface should be treated as a mirror instead (pbrt's threshold).
    bool effectively_smooth() const { return std::max(alpha_x, alpha_y) < 1e-3f; }

    /// Density of facet normals: area of facets per area of surface and solid angle [1/sr];
    /// ∫ D(m) m.z dm = 1.
    float D(Vector3 m) const;

    /// Projected area, towards w, of the facets that w sees, over the area of the surface:
    /// |cos θ| (1 + Λ(w)), written so that it stays finite in the plane.
    float visible_area(Vector3 w) const;

    /// Smith's auxiliary function; infinite in the plane.
    float lambda(Vector3 w) const { return visible_area(w) / std::abs(w.z) - 1; }
    /// Fraction of the facets seen from w, for facets that face w.
    float G1(Vector3 w) const { return std::abs(w.z) / visible_area(w); }
    /// Fraction seen from both sides, with heights correlated: 1 / (1 + Λ(wo) + Λ(wi)).
    float G(Vector3 wo, Vector3 wi) const { return std::abs(wo.z * wi.z) * visibility(wo, wi); }
    /// G / (|cos θo| |cos θi|), finite at grazing angles where the quotient is not.
    float visibility(Vector3 wo, Vector3 wi) const;

    /// Draws a normal among those that `w` sees, by projected area.
    Vector3 sample_visible_normal(Vector3 w, Vector2 u) const;
    /// Density with which `m` is drawn [1/sr].
    float visible_normal_pdf(Vector3 w, Vector3 m) const {
        const float facing = w.z < 0 ? -glm::dot(w, m) : glm::dot(w, m);
        return facing > 0 ? D(m) * facing / visible_area(w) : 0.0f;
    }

    Type type;
    float alpha_x, alpha_y;
};

}  // namespace lucerna
