// SPDX-License-Identifier: Apache-2.0
/// principled: Disney's material, with parameters for artists (plugins/bsdfs/disney.h).
///
/// Four lobes are added: a matte one with sheen, a rough highlight whose reflectance is between
/// that of a dielectric and of a metal, rough refraction, and a clear coat. With metallic m and
/// spec_trans s their weights are (1 − m)(1 − s), 1, (1 − m) s and clearcoat / 4:
///
///     highlight:  F D G / (4 cos θo cos θi)
///     refraction: √base (1 − F) D G |wo·m wi·m| / (|cos θo cos θi| (wi·m + wo·m / η)²)
///     coat:       Schlick(0.04) GTR1 G / 4
///
/// From inside there are only reflection and refraction by the facets. The sum is symmetric but can
/// exceed 1 at grazing angles: the matte lobe does not know what the highlight took.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"
#include "plugins/bsdfs/disney.h"
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/ior.h"

namespace lucerna {
namespace {

/// "Generalized Trowbridge-Reitz" with exponent 1: a small core, a wide tail ([2012], appendix B).
struct GTR1 {
    float alpha2;

    /// ∫ D(m) m.z dm = 1 [1/sr].
    float D(Vector3 m) const {
        return (alpha2 - 1) / (pi * std::log(alpha2) * (sin2_theta(m) + alpha2 * cos2_theta(m)));
    }
    /// Normals with the density D(m) m.z.
    Vector3 sample(Vector2 u) const {
        const float sin2 = alpha2 * std::expm1(-u.y * std::log(alpha2)) / (1 - alpha2);
        const Vector2 side = safe_sqrt(sin2) * unit_circle(u.x);
        return {side.x, side.y, safe_sqrt(1 - sin2)};
    }
};

/// Masking of the coat, whatever its gloss.
const Microfacet coat_masking(Microfacet::Type::ggx, 0.25f, 0.25f);

class Principled final : public BSDF {
public:
    explicit Principled(const Params& params)
        : surface_(params),
          metallic_(disney::Surface::part(params, "metallic", 0, "0: dielectric; 1: metal")),
          clearcoat_(disney::Surface::part(params, "clearcoat", 0, "strength of the clear coat")),
          gloss_(disney::Surface::part(params, "clearcoat_gloss", 0, "0: satin; 1: gloss")),
          diffuse_rate_(
              disney::Surface::rate(params, "diffuse_reflectance_sampling_rate", "matte lobe")),
          main_rate_(disney::Surface::rate(params, "main_specular_sampling_rate", "highlight")),
          coat_rate_(disney::Surface::rate(params, "clearcoat_sampling_rate", "clear coat")),
          eta_(index(params)) {}

    Lobe lobes() const override {
        const Lobe opaque = Lobe::diffuse_reflection | Lobe::glossy_reflection;
        return transmits() ? opaque | Lobe::glossy_transmission : opaque;
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        const Point here(*this, at, wo);
        if (here.dark() || wo.z * wi.z == 0) return {};
        if (!same_hemisphere(wo, wi)) return refracted(here, wo, wi, mode);
        return wo.z > 0 ? outside(here, wo, wi) : inside(here, wo, wi);
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        const Point here(*this, at, wo);
        if (here.dark()) return {};
        if (u_lobe < here.matte) {
            const Vector3 wi = square_to_cosine_hemisphere(u);
            return drawn(*this, at, wo, wi, mode, Lobe::diffuse_reflection);
        }
        if (u_lobe < here.matte + here.coat) {
            const Vector3 wi = reflect(wo, coat(at).sample(u));
            if (!same_hemisphere(wo, wi)) return {};
            return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
        }
        const float chosen = rescaled(u_lobe, here.matte + here.coat, 1);
        const Vector3 m = here.facets.sample_visible_normal(wo, u);
        if (chosen < here.reflects(fresnel_dielectric(glm::dot(wo, m), eta_))) {
            const Vector3 wi = reflect(wo, m);
            if (!same_hemisphere(wo, wi)) return {};
            return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
        }
        const std::optional<Refraction> bent = refract(wo, m, eta_);
        if (!bent || same_hemisphere(wo, bent->direction)) return {};
        return drawn(*this, at, wo, bent->direction, mode, Lobe::glossy_transmission, bent->eta);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        const Point here(*this, at, wo);
        if (here.dark()) return Color(0);
        const float reflected = fresnel_dielectric(wo.z, eta_);
        const Color through = glm::sqrt(here.base) * (1 - reflected);
        if (wo.z < 0) return here.glass * (Color(reflected) + through);
        const Color highlight = reflectance(here, wo.z);
        return glm::min(here.opaque * here.base + here.glass * through + highlight, Color(1));
    }

private:
    /// The parameters at a point, and the probability of each lobe for a given direction.
    struct Point {
        Point(const Principled& b, const Interaction& at_, Vector3 wo)
            : at(at_),
              base(b.surface_.base_color(at)),
              metallic(b.metallic_(at)),
              front(wo.z > 0),
              facets(b.surface_.facets_at(at)) {
            const float clear = b.surface_.spec_trans(at);
            opaque = (1 - metallic) * (1 - clear);
            glass = (1 - metallic) * clear;
            clearcoat = b.clearcoat_(at);
            grazing = wo.z == 0;
            if (!front) return;
            matte = b.diffuse_rate_ * opaque;
            coat = 0.25f * b.coat_rate_ * clearcoat;
            main = b.main_rate_;
            const float sum = matte + coat + main;
            matte /= sum;
            coat /= sum;
            main /= sum;
        }

        /// Nothing is scattered: in the plane, or inside what does not transmit.
        bool dark() const { return grazing || (!front && glass == 0); }
        /// Probability that a facet of reflectance `fresnel` reflects, rather than refracts.
        float reflects(float fresnel) const { return front ? 1 - glass * (1 - fresnel) : fresnel; }

        const Interaction& at;
        Color base;
        float metallic;
        bool front, grazing = false;
        Microfacet facets;
        float opaque, glass, clearcoat;       ///< weights of the lobes
        float matte = 0, coat = 0, main = 1;  ///< probabilities
    };

    float index(const Params& params) const {
        float specular = params.real("specular", 0.5, unit_interval,
                                     "reflectance of the highlight; 0.5: η is 1.5");
        float eta = params.real("eta", 1.5, ior_range,
                                "index of refraction, inside over outside, for specular");
        const bool by_eta = params.has("eta");
        if (by_eta && params.has("specular")) {
            params.error("eta", "give either \"eta\" or \"specular\"");
        }
        if (transmits() && (by_eta ? eta == 1 : specular == 0)) {
            params.warning(by_eta ? "eta" : "specular", by_eta
                                                            ? "1 does not refract; 1.001 is taken"
                                                            : "0 does not refract; 0.001 is taken");
            eta = 1.001f;
            specular = 0.001f;
        }
        return by_eta ? eta : 2 / (1 - std::sqrt(0.08f * specular)) - 1;
    }

    bool transmits() const {
        return disney::Surface::used(surface_.spec_trans) &&
               (metallic_.texture || metallic_.constant < 1);
    }

    /// The width of the coat's facets is 0.1 to 0.001.
    GTR1 coat(const Interaction& at) const { return {sqr(glm::mix(0.1f, 0.001f, gloss_(at)))}; }

    /// Reflectance of the highlight, from outside.
    Color reflectance(const Point& here, float cos_theta) const {
        const Color dielectric = surface_.tinted(here.at, here.base, cos_theta, eta_);
        if (here.metallic == 0) return dielectric;
        return glm::mix(dielectric, disney::schlick(here.base, cos_theta, eta_), here.metallic);
    }

    BSDFValue outside(const Point& here, Vector3 wo, Vector3 wi) const {
        const Vector3 sum = wo + wi;
        const float length = glm::length(sum), cos_d = std::min(0.5f * length, 1.0f);
        if (length == 0) return {};
        const Vector3 m = sum / length;
        BSDFValue value;
        value.f = reflectance(here, cos_d) * disney::mirror_value(here.facets, m, wo, wi);
        if (here.opaque > 0) {
            value.f += here.opaque * surface_.matte_value(here.at, here.base, wo, wi, cos_d) +
                       (1 - here.metallic) * surface_.sheen_value(here.at, here.base, cos_d);
        }
        value.pdf = here.main * here.reflects(fresnel_dielectric(cos_d, eta_)) *
                        disney::mirror_pdf(here.facets, m, wo) +
                    here.matte * square_to_cosine_hemisphere_pdf(wi);
        if (here.clearcoat == 0) return value;
        const float D = coat(here.at).D(m);
        const float masking = coat_masking.G1(wo) * coat_masking.G1(wi);
        value.f +=
            disney::schlick(Color(0.04f), cos_d, eta_) * (0.25f * here.clearcoat * D * masking);
        value.pdf += here.coat * D * m.z / (4 * cos_d);
        return value;
    }

    BSDFValue inside(const Point& here, Vector3 wo, Vector3 wi) const {
        const Vector3 sum = -(wo + wi);
        const float length = glm::length(sum);
        if (length == 0) return {};
        const float fresnel = fresnel_dielectric(-0.5f * length, eta_);
        const Vector3 m = sum / length;
        return {Color(here.glass * fresnel * disney::mirror_value(here.facets, m, wo, wi)),
                fresnel * disney::mirror_pdf(here.facets, m, wo)};
    }

    BSDFValue refracted(const Point& here, Vector3 wo, Vector3 wi, TransportMode mode) const {
        if (here.glass == 0) return {};
        const float there = relative_eta(wo.z, eta_);
        // In double: for nearly equal indices the sum almost vanishes.
        const Vector3d o(wo), i(wi), sum = i * static_cast<double>(there) + o;
        const Vector3d m = glm::normalize(sum.z < 0 ? -sum : sum);
        const double om = glm::dot(o, m), im = glm::dot(i, m);
        // Facets must be seen from the side on which the direction lies.
        if (!(om * o.z > 0 && im * i.z > 0)) return {};
        const float fresnel = fresnel_dielectric(static_cast<float>(there > 1 ? om : im), eta_);
        const double jacobian = std::abs(om * im) / sqr(im + om / static_cast<double>(there));
        const float density =
            here.facets.D(Vector3(m)) * static_cast<float>(jacobian) / here.facets.visible_area(wo);
        const float compression = mode == TransportMode::radiance ? 1 / sqr(there) : 1.0f;
        const float weight = here.glass * (1 - fresnel) * compression;
        return {glm::sqrt(here.base) * (weight * density / here.facets.visible_area(wi)),
                here.main * (1 - here.reflects(fresnel)) * density};
    }

    disney::Surface surface_;
    FloatInput metallic_, clearcoat_, gloss_;
    float diffuse_rate_, main_rate_, coat_rate_, eta_;
};

}  // namespace

const PluginInfo plugin = describe<Principled>("Disney's material: plastic, metal, glass, cloth");

}  // namespace lucerna
