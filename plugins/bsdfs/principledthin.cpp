// SPDX-License-Identifier: Apache-2.0
/// principledthin: Disney's material for sheets without thickness, as leaves, paper, panes
/// (plugins/bsdfs/disney.h).
///
/// With spec_trans s and half of diff_trans, d, four lobes are added on either side:
///
///     (1 − s) (1 − d) matte and sheen,    (1 − s) d base / π through the sheet,
///     s F D G / (4 cos θo cos θi),        s base (1 − F) D' G' / (4 cos θo cos θi') through it
///
/// where wi' is wi mirrored to the side of wo, and D' is narrower or wider by η ([2015], figure
/// 15): light is not bent.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"
#include "plugins/bsdfs/disney.h"
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/ior.h"

namespace lucerna {
namespace {

class PrincipledThin final : public BSDF {
public:
    explicit PrincipledThin(const Params& params)
        : surface_(params),
          eta_(params.float_input("eta", 1.5f, ior_range, "index of refraction of the sheet")),
          diff_trans_(params.float_input("diff_trans", 0, Range{.min = 0, .max = 2},
                                         "matte light that goes through; 1: half, 2: all")),
          matte_rate_(disney::Surface::rate(params, "diffuse_reflectance_sampling_rate",
                                            "matte reflection")),
          mirror_rate_(
              disney::Surface::rate(params, "specular_reflectance_sampling_rate", "highlight")),
          pane_rate_(disney::Surface::rate(params, "specular_transmittance_sampling_rate",
                                           "transmitted highlight")),
          through_rate_(disney::Surface::rate(params, "diffuse_transmittance_sampling_rate",
                                              "matte transmission")) {}

    Lobe lobes() const override {
        Lobe all = Lobe::diffuse_reflection;
        if (disney::Surface::used(diff_trans_)) all = all | Lobe::diffuse_transmission;
        if (!disney::Surface::used(surface_.spec_trans)) return all;
        return all | Lobe::glossy_reflection | Lobe::glossy_transmission;
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        if (wo.z * wi.z == 0) return {};
        const bool through = !same_hemisphere(wo, wi);
        const Point here(*this, at, wo);
        const Vector3 o = above(wo), i = wo.z < 0 ? -wi : wi;
        const Vector3 mirrored(i.x, i.y, std::abs(i.z));
        const Vector3 sum = o + mirrored;
        const float length = glm::length(sum), cos_d = std::min(0.5f * length, 1.0f);
        if (length == 0) return {};
        BSDFValue value = matte(here, o, mirrored, cos_d, through);
        if (here.clear == 0) return value;
        const Vector3 m = sum / length;
        const Microfacet facets = here.facets(*this, through);
        const float share = through ? here.pane : here.mirror;
        value.f += here.clear * fraction(here, cos_d, through) *
                   disney::mirror_value(facets, m, o, mirrored);
        value.pdf += share * disney::mirror_pdf(facets, m, o);
        return value;
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (wo.z == 0) return {};
        const Point here(*this, at, wo);
        const bool rough = u_lobe < here.mirror + here.pane;
        const bool through = rough
                                 ? u_lobe >= here.mirror
                                 : here.veil > 0 && u_lobe >= here.mirror + here.pane + here.matte;
        Vector3 wi;
        if (rough) {
            const Vector3 o = above(wo);
            wi = reflect(o, here.facets(*this, through).sample_visible_normal(o, u));
            if (!(wi.z > 0)) return {};
        } else {
            wi = square_to_cosine_hemisphere(u);
        }
        if (through) wi.z = -wi.z;
        if (wo.z < 0) wi = -wi;
        return drawn(*this, at, wo, wi, mode, lobe(rough, through));
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        const Point here(*this, at, wo);
        const float cos_theta = std::abs(wo.z);
        const Color clear = fraction(here, cos_theta, false) + fraction(here, cos_theta, true);
        return glm::min((1 - here.clear) * here.base + here.clear * clear, Color(1));
    }

private:
    /// The parameters at a point, and the probabilities of the lobes.
    struct Point {
        Point(const PrincipledThin& b, const Interaction& at_, Vector3 wo)
            : at(at_),
              base(b.surface_.base_color(at)),
              clear(b.surface_.spec_trans(at)),
              eta(b.eta_(at)),
              transmitted(0.5f * b.diff_trans_(at)),
              mirror(b.mirror_rate_ * clear),
              pane(b.pane_rate_ * clear),
              matte(b.matte_rate_ * (1 - clear) * (1 - transmitted)),
              veil(b.through_rate_ * (1 - clear) * transmitted) {
            // Steep facets reflect more than the sheet does on the whole: never none.
            const float reflected = glm::mix(fresnel_dielectric(std::abs(wo.z), eta), 1.0f, 0.02f);
            mirror *= reflected;
            pane *= 1 - 0.98f * reflected;
            const float sum = mirror + pane + matte + veil;
            mirror /= sum;
            pane /= sum;
            matte /= sum;
            veil /= sum;
        }

        Microfacet facets(const PrincipledThin& b, bool through) const {
            return b.surface_.facets_at(at, through ? 0.65f * eta - 0.35f : 1.0f);
        }

        const Interaction& at;
        Color base;
        float clear, eta, transmitted;
        float mirror, pane, matte, veil;  ///< probabilities
    };

    static Vector3 above(Vector3 w) { return w.z < 0 ? -w : w; }

    static Lobe lobe(bool rough, bool through) {
        if (rough) return through ? Lobe::glossy_transmission : Lobe::glossy_reflection;
        return through ? Lobe::diffuse_transmission : Lobe::diffuse_reflection;
    }

    /// The fraction of light that facets reflect, or let through.
    Color fraction(const Point& here, float cos_theta, bool through) const {
        if (!through) return surface_.tinted(here.at, here.base, cos_theta, here.eta);
        return here.base * (1 - fresnel_dielectric(cos_theta, here.eta));
    }

    BSDFValue matte(const Point& here, Vector3 wo, Vector3 wi, float cos_d, bool through) const {
        const float cosine_pdf = square_to_cosine_hemisphere_pdf(wi);
        const float weight = 1 - here.clear;
        if (through) {
            return {here.base * (weight * here.transmitted * inv_pi), here.veil * cosine_pdf};
        }
        const Color f = surface_.matte_value(here.at, here.base, wo, wi, cos_d) +
                        surface_.sheen_value(here.at, here.base, cos_d);
        return {f * (weight * (1 - here.transmitted)), here.matte * cosine_pdf};
    }

    disney::Surface surface_;
    FloatInput eta_, diff_trans_;
    float matte_rate_, mirror_rate_, pane_rate_, through_rate_;
};

}  // namespace

const PluginInfo plugin = describe<PrincipledThin>("Disney's material for thin sheets");

}  // namespace lucerna
