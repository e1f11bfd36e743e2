// SPDX-License-Identifier: Apache-2.0
/// Plastics: a matte base below a smooth or rough transparent coat.
///
///     f = specular + (1 − R(θo)) (1 − R(θi)) ρ / (π η² (1 − ρ r))
///
/// R is the fraction of light from one direction that the coat reflects, r that of diffuse light
/// which comes back from the base, by 1 − r = (1 − R̄) / η² with the mean R̄ over the hemisphere.
/// So the surface with ρ = 1 reflects all light, any other less, and f is symmetric (Kelemen and
/// Szirmay-Kalos 2001; for smooth coats the same as in Jakob's Mitsuba). R of a rough coat is
/// tabulated by numerical integration. If not `nonlinear`, ρ below the line is taken for 1.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/math/fresnel.h"
#include "core/math/microfacet.h"
#include "core/math/warp.h"
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/ior.h"

#include <array>

namespace lucerna {

/// The part of light from one direction that a coat reflects.
class CoatReflectance {
public:
    /// `facets` null: a smooth coat.
    CoatReflectance(const Microfacet* facets, float eta) : eta_(eta), rough_(facets) {
        if (!facets) return;
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const float t = static_cast<float>(i) / last;
            table_[i] = integrate(*facets, t * t);
        }
    }

    float operator()(float cos_theta) const {
        if (!rough_) return fresnel_dielectric(cos_theta, eta_);
        const float x = std::sqrt(cos_theta) * last;
        const std::size_t i = std::min(static_cast<std::size_t>(x), table_.size() - 2);
        const float t = x - static_cast<float>(i);
        return (1 - t) * table_[i] + t * table_[i + 1];
    }

private:
    /// Normals are drawn as when rendering, but at the centres of a grid of random numbers.
    float integrate(const Microfacet& facets, float cos_theta) const {
        constexpr int n = 32;
        const Vector3 wo(safe_sqrt(1 - sqr(cos_theta)), 0, cos_theta);
        double sum = 0;
        for (int i = 0; i < n * n; ++i) {
            const Vector2 u((static_cast<float>(i % n) + 0.5f) / n,
                            (static_cast<float>(i / n) + 0.5f) / n);
            const Vector3 m = facets.sample_visible_normal(wo, u);
            const Vector3 wi = reflect(wo, m);
            if (!(wi.z > 0)) continue;
            sum += fresnel_dielectric(glm::dot(wo, m), eta_) * facets.visible_area(wo) *
                   facets.visibility(wo, wi) * wi.z;
        }
        return static_cast<float>(sum / (n * n));
    }

    static constexpr float last = 63;
    float eta_;
    bool rough_;
    /// At cos θ = t² for t in equal steps: R is steep at grazing angles.
    std::array<float, 64> table_{};
};

class PlasticBSDF : public BSDF {
public:
    Lobe lobes() const override {
        return Lobe::diffuse_reflection |
               (facets_ ? Lobe::glossy_reflection : Lobe::specular_reflection);
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const float reflected = coat_(wo.z), p = coat_probability(reflected);
        BSDFValue value{base(at) * ((1 - reflected) * (1 - coat_(wi.z))),
                        (1 - p) * square_to_cosine_hemisphere_pdf(wi)};
        if (!facets_) return value;
        const Vector3 m = glm::normalize(wo + wi);
        const float density = 0.25f * facets_->D(m);
        value.f += specular_(at) * (density * facets_->visibility(wo, wi) *
                                    fresnel_dielectric(glm::dot(wo, m), eta_));
        value.pdf += p * density / facets_->visible_area(wo);
        return value;
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (!(wo.z > 0)) return {};
        const float reflected = coat_(wo.z), p = coat_probability(reflected);
        if (!(u_lobe < p)) {
            const Vector3 wi = square_to_cosine_hemisphere(u);
            return drawn(*this, at, wo, wi, mode, Lobe::diffuse_reflection);
        }
        if (facets_) {
            const Vector3 wi = reflect(wo, facets_->sample_visible_normal(wo, u));
            return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
        }
        return BSDFSample{.wi = reflect(wo),
                          .weight = specular_(at) * (reflected / p),
                          .pdf = p,
                          .lobe = Lobe::specular_reflection};
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        const float reflected = wo.z > 0 ? coat_(wo.z) : 1.0f;
        return specular_(at) * reflected +
               base(at) * (pi * (1 - reflected) * (1 - mean_reflectance_));
    }

protected:
    /// Without `facets` the coat is smooth.
    PlasticBSDF(const Params& params, std::optional<Microfacet> facets)
        : facets_(facets && !facets->effectively_smooth() ? facets : std::nullopt),
          eta_(relative_ior(params, "polypropylene")),
          diffuse_(params.color_input("diffuse_reflectance", Color(0.5f), unit_interval,
                                      "fraction of light that the base reflects")),
          specular_(params.color_input("specular_reflectance", Color(1), unit_interval,
                                       "factor of light reflected by the coat; 1 is physical")),
          nonlinear_(params.boolean("nonlinear", false,
                                    "shift colours by reflections between the base and the coat")),
          coat_(facets_ ? &*facets_ : nullptr, eta_),
          mean_reflectance_(average_reflectance([this](float mu) { return coat_(mu); })) {
        const float specular = luminance(specular_.mean()), diffuse = luminance(diffuse_.mean());
        specular_share_ = specular > 0 ? specular / (specular + diffuse) : 0.0f;
    }

private:
    /// Value of the base as seen through a coat that reflects nothing.
    Color base(const Interaction& at) const {
        const float eta2 = sqr(eta_), internal = 1 - (1 - mean_reflectance_) / eta2;
        const Color rho = diffuse_(at);
        return rho / ((Color(1) - (nonlinear_ ? rho : Color(1)) * internal) * (pi * eta2));
    }

    /// Probability of the coat's lobe, by how much light each lobe is expected to send back.
    float coat_probability(float reflected) const {
        const float coat = reflected * specular_share_;
        const float below = (1 - reflected) * (1 - specular_share_);
        return coat > 0 ? coat / (coat + below) : 0.0f;
    }

    std::optional<Microfacet> facets_;
    float eta_;
    ColorInput diffuse_, specular_;
    bool nonlinear_;
    CoatReflectance coat_;
    float mean_reflectance_;
    float specular_share_;
};

}  // namespace lucerna
