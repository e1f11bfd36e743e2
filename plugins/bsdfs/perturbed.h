// SPDX-License-Identifier: Apache-2.0
/// Bump and normal maps: a BSDF around another normal than the surface has.
///
/// In the perturbed frame (primed) the nested BSDF scatters, and its cosine is the one that counts:
///
///     f(wo, wi) |cos θi| = nested(wo', wi') |cos θi'| S(wi)                   for radiance
///
/// and with the cosines of wo for importance, which makes each the adjoint of the other (Veach
/// 1997, 5.3). A direction must lie on the same side of both surfaces, else light would leak. But
/// where the perturbed surface turns away from the viewer, the tilt of its normal is reversed
/// instead of turning black (`flip_invalid_normals`). A particle does not know the viewer before
/// it is scattered: it draws from either frame.
///
/// S is the shadow that the bumps cast on themselves when the light is low
/// (`use_shadowing_function`; Conty Estevez et al. 2019, "A Microfacet-Based Shadowing Function to
/// Solve the Bump Terminator Problem"), by the angle of light with the unperturbed normal.
#pragma once

#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"

namespace lucerna {

class PerturbedBSDF : public BSDF {
public:
    Lobe lobes() const override { return nested_.lobes(); }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        return evaluate(View(*this, at, wo, mode), wi);
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        const View view(*this, at, wo, mode);
        const bool flipped = u_lobe < view.flipped_probability;
        const Side& side = flipped ? *view.flipped : view.bent;
        if (!side.sees_wo) return {};
        const float low = flipped ? 0 : view.flipped_probability;
        const float high = flipped ? view.flipped_probability : 1;
        std::optional<BSDFSample> s =
            nested_.sample(side.at, side.wo, rescaled(u_lobe, low, high), u, mode);
        if (!s) return {};
        s->wi = at.to_local(side.at.to_world(s->wi));
        if (!same_hemisphere(s->wi, view.seen_from(side, s->wi))) return {};
        return s->specular() ? delta(view, *s, flipped) : smooth(view, *s);
    }

    Color transmittance(const Interaction& at, Vector3 wo) const override {
        const View view(*this, at, wo, TransportMode::radiance);
        const Side& side = view.flipped ? *view.flipped : view.bent;
        return side.sees_wo ? nested_.transmittance(side.at, side.wo)
                            : nested_.transmittance(at, wo);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return nested_.albedo(at, wo);
    }

protected:
    explicit PerturbedBSDF(const Params& params)
        : nested_(*params.all_nested<BSDF>({1, 1}, "what the surface is made of").front()),
          shadows_(
              params.boolean("use_shadowing_function", true, "low light is shadowed by the bumps")),
          flips_(params.boolean("flip_invalid_normals", true,
                                "normals turned away from the viewer are tilted the other way; "
                                "else the surface is black there")) {}

    /// In world space; `at.shading` where nothing is perturbed.
    virtual Frame perturbed(const Interaction& at) const = 0;

private:
    /// A point in one of the perturbed frames, and the given direction there.
    struct Side {
        Interaction at;  ///< the same point, but for the frame
        Vector3 wo;
        bool sees_wo;  ///< wo lies on the same side as in the surface's own frame
    };

    /// A point in all frames, and the given direction.
    struct View {
        View(const PerturbedBSDF& bsdf, const Interaction& at_, Vector3 wo_, TransportMode mode_)
            : at(at_), wo(wo_), mode(mode_) {
            const Frame frame = bsdf.perturbed(at);
            const Vector3 normal = at.to_local(frame.n);
            const float tilt2 = normal.x * normal.x + normal.y * normal.y;
            if (bsdf.shadows_) {
                alpha2 = std::min(0.125f * tilt2 / std::max(normal.z * normal.z, 1e-6f), 1.0f);
            }
            bent = side(frame);
            const bool particle = mode == TransportMode::importance;
            if (!bsdf.flips_ || (bent.sees_wo && !particle)) return;
            // Any direction that the one frame does not see is seen by the other.
            flipped = side(Frame::from_normal_tangent(
                at.to_world(Vector3(-normal.x, -normal.y, normal.z)), at.dpdu));
            if (!flipped->sees_wo) return;
            flipped_probability = bent.sees_wo ? 0.5f * std::sqrt(tilt2) : 1.0f;
        }

        Vector3 seen_from(const Side& side, Vector3 w) const {
            return side.at.to_local(at.to_world(w));
        }

        /// Whether the viewer, who looks from wi if particles move, is shown the reversed tilt.
        bool shows_flipped(Vector3 wi) const {
            return mode == TransportMode::radiance ? !bent.sees_wo
                                                   : !same_hemisphere(wi, seen_from(bent, wi));
        }

        /// The share of light that the bumps let through; `cos_theta`: between light and the
        /// surface's own normal.
        float shadow(float cos_theta) const {
            const float cos2 = std::max(cos_theta * cos_theta, 1e-12f);
            return 2 / (1 + std::sqrt(1 + alpha2 * (1 - cos2) / cos2));
        }

        const Interaction& at;
        Vector3 wo;
        TransportMode mode;
        float alpha2 = 0;  ///< squared roughness of the bumps that shadow each other
        Side bent;
        std::optional<Side> flipped;    ///< where it may be drawn or shown
        float flipped_probability = 0;  ///< of drawing from it

    private:
        Side side(const Frame& frame) const {
            Side result{.at = at, .wo = {}, .sees_wo = false};
            result.at.shading = frame;
            result.wo = seen_from(result, wo);
            result.sees_wo = same_hemisphere(wo, result.wo);
            return result;
        }
    };

    BSDFValue evaluate(const View& view, Vector3 wi) const {
        BSDFValue value;
        const bool shows_flipped = view.shows_flipped(wi);
        const auto add = [&](const Side& side, bool shown, float probability) {
            const Vector3 side_wi = view.seen_from(side, wi);
            if (!side.sees_wo || !same_hemisphere(wi, side_wi)) return;
            const BSDFValue v = nested_.evaluate(side.at, side.wo, side_wi, view.mode);
            value.pdf += probability * v.pdf;
            if (!shown) return;
            const bool radiance = view.mode == TransportMode::radiance;
            const float cos_light = radiance ? wi.z : view.wo.z;
            value.f =
                v.f * ((radiance ? side_wi.z : side.wo.z) / cos_light) * view.shadow(cos_light);
        };
        add(view.bent, !shows_flipped, 1 - view.flipped_probability);
        if (view.flipped) add(*view.flipped, shows_flipped, view.flipped_probability);
        return value;
    }

    std::optional<BSDFSample> smooth(const View& view, BSDFSample s) const {
        const BSDFValue value = evaluate(view, s.wi);
        if (!(value.pdf > 0)) return {};
        s.weight = value.f * (abs_cos_theta(s.wi) / value.pdf);
        s.pdf = value.pdf;
        return s;
    }

    /// A delta lobe belongs to one frame only: to the one which the viewer is shown.
    static std::optional<BSDFSample> delta(const View& view, BSDFSample s, bool flipped) {
        if (flipped != view.shows_flipped(s.wi)) return {};
        const float probability = flipped ? view.flipped_probability : 1 - view.flipped_probability;
        s.pdf *= probability;
        s.weight /= probability;
        if (s.lobe == Lobe::null) return s;
        if (view.mode == TransportMode::radiance) {
            s.weight *= view.shadow(s.wi.z);
            return s;
        }
        const Side& side = flipped ? *view.flipped : view.bent;
        s.weight *= view.shadow(view.wo.z) * side.wo.z * s.wi.z /
                    (view.wo.z * view.seen_from(side, s.wi).z);
        return s;
    }

    const BSDF& nested_;
    bool shadows_, flips_;
};

}  // namespace lucerna
