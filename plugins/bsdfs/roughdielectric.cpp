// SPDX-License-Identifier: Apache-2.0
/// roughdielectric: a rough boundary between two transparent substances, as ground glass.
///
/// Facets are smooth dielectrics:
///
///     fr(wo, wi) = F D(m) G / (4 |cos θo cos θi|)
///     ft(wo, wi) = (1 − F) D(m) G |wo·m wi·m| / (|cos θo cos θi| (wi·m + wo·m / η)²)
///
/// with η along wi over along wo; for radiance ft / η² (Walter et al. 2007, eq. 20, 21; pbrt 4e,
/// 9.7). Light that would meet several facets is lost.
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/glass.h"
#include "plugins/bsdfs/ior.h"
#include "plugins/bsdfs/roughness.h"

namespace lucerna {
namespace {

class RoughDielectric final : public BSDF {
public:
    explicit RoughDielectric(const Params& params)
        : roughness_(params), glass_(params, relative_ior(params, "bk7")) {}

    Lobe lobes() const override {
        if (glass_.matched()) return Lobe::null;
        return roughness_.lobes(Lobe::glossy_reflection | Lobe::glossy_transmission,
                                Lobe::specular_reflection | Lobe::specular_transmission);
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        const Microfacet facets = roughness_(at);
        if (wo.z * wi.z == 0 || smooth(facets)) return {};
        return same_hemisphere(wo, wi) ? reflection(facets, at, wo, wi)
                                       : transmission(facets, at, wo, wi, mode);
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (wo.z == 0) return {};
        const Microfacet facets = roughness_(at);
        if (smooth(facets)) return glass_.sample_smooth(at, wo, u_lobe, mode);
        const Vector3 m = facets.sample_visible_normal(wo, u);
        if (u_lobe < fresnel_dielectric(glm::dot(wo, m), glass_.eta)) {
            const Vector3 wi = reflect(wo, m);
            if (!same_hemisphere(wo, wi)) return {};
            return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
        }
        const std::optional<Refraction> refracted = refract(wo, m, glass_.eta);
        if (!refracted || same_hemisphere(wo, refracted->direction)) return {};
        return drawn(*this, at, wo, refracted->direction, mode, Lobe::glossy_transmission,
                     refracted->eta);
    }

    Color transmittance(const Interaction& at, Vector3) const override {
        return glass_.straight(at);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return glass_.albedo(at, wo.z);
    }

private:
    bool smooth(const Microfacet& facets) const {
        return glass_.matched() || facets.effectively_smooth();
    }

    BSDFValue reflection(const Microfacet& facets, const Interaction& at, Vector3 wo,
                         Vector3 wi) const {
        const Vector3 sum = wo.z < 0 ? -(wo + wi) : wo + wi;
        const float length = glm::length(sum);
        // wo · m = wi · m is half the length: symmetric even where F is steep.
        const float reflected = fresnel_dielectric(std::copysign(0.5f * length, wo.z), glass_.eta);
        const float density = 0.25f * facets.D(sum / length) * reflected;
        return {glass_.reflectance(at) * (density * facets.visibility(wo, wi)),
                density / facets.visible_area(wo)};
    }

    BSDFValue transmission(const Microfacet& facets, const Interaction& at, Vector3 wo, Vector3 wi,
                           TransportMode mode) const {
        const float there = relative_eta(wo.z, glass_.eta);
        // In double: for nearly equal indices the sum almost vanishes.
        const Vector3d o(wo), i(wi), sum = i * static_cast<double>(there) + o;
        const Vector3d m = glm::normalize(sum.z < 0 ? -sum : sum);
        const double om = glm::dot(o, m), im = glm::dot(i, m);
        // Facets must be seen from the side on which the direction lies.
        if (!(om * o.z > 0 && im * i.z > 0)) return {};
        // From the thinner side, where F is not steep: both directions then give the same.
        const float reflected =
            fresnel_dielectric(static_cast<float>(there > 1 ? om : im), glass_.eta);
        const double jacobian = std::abs(om * im) / sqr(im + om / static_cast<double>(there));
        const float density = facets.D(Vector3(m)) * static_cast<float>(jacobian) * (1 - reflected);
        return {glass_.transmitted(at, there, mode) * (density * facets.visibility(wo, wi)),
                density / facets.visible_area(wo)};
    }

    Roughness roughness_;
    Glass glass_;
};

}  // namespace

const PluginInfo plugin = describe<RoughDielectric>("a rough transparent substance");

}  // namespace lucerna
