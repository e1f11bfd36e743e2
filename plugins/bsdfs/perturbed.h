// SPDX-License-Identifier: Apache-2.0
/// Bump and normal maps: a BSDF around another normal than the surface has.
///
/// In the perturbed frame (primed) the nested BSDF scatters, and its cosine is the one that counts:
///
///     f(wo, wi) |cos θi| = nested(wo', wi') |cos θi'|                         for radiance
///
/// and with the cosines of wo for importance, which makes each the adjoint of the other (Veach
/// 1997, 5.3). A direction must lie on the same side of both surfaces, else light would leak. But
/// where the perturbed surface turns away from the viewer, the surface keeps its own normal instead
/// of turning black. A particle does not know the viewer before it is scattered: it draws from
/// either frame.
#pragma once

#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"

namespace lucerna {

class PerturbedBSDF : public BSDF {
public:
    Lobe lobes() const override { return nested_.lobes(); }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        return evaluate(View(at, perturbed(at), wo, mode), wi);
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        const View view(at, perturbed(at), wo, mode);
        const bool own = u_lobe < view.own_probability;
        std::optional<BSDFSample> s =
            own ? nested_.sample(at, wo, rescaled(u_lobe, 0, view.own_probability), u, mode)
                : nested_.sample(view.bent, view.bent_wo, rescaled(u_lobe, view.own_probability, 1),
                                 u, mode);
        if (!s) return {};
        if (!own) s->wi = at.to_local(view.bent.to_world(s->wi));
        const Vector3 bent_wi = view.bend(s->wi);
        if (!own && !same_hemisphere(s->wi, bent_wi)) return {};
        return s->specular() ? delta(view, *s, bent_wi, own) : smooth(view, *s);
    }

    Color transmittance(const Interaction& at, Vector3 wo) const override {
        const View view(at, perturbed(at), wo, TransportMode::radiance);
        return view.sees_wo ? nested_.transmittance(view.bent, view.bent_wo)
                            : nested_.transmittance(at, wo);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return nested_.albedo(at, wo);
    }

protected:
    explicit PerturbedBSDF(const BSDF& nested) : nested_(nested) {}

    /// In world space; `at.shading` where nothing is perturbed.
    virtual Frame perturbed(const Interaction& at) const = 0;

private:
    /// A point in both frames, and the given direction.
    struct View {
        View(const Interaction& at_, const Frame& frame, Vector3 wo_, TransportMode mode_)
            : at(at_), bent(at_), wo(wo_), mode(mode_) {
            bent.shading = frame;
            bent_wo = bend(wo);
            sees_wo = same_hemisphere(wo, bent_wo);
            const Vector3 tilt = glm::cross(at.shading.n, frame.n);
            const bool particle = mode == TransportMode::importance;
            own_probability = !sees_wo ? 1.0f : particle ? 0.5f * glm::length(tilt) : 0.0f;
        }

        Vector3 bend(Vector3 w) const { return bent.to_local(at.to_world(w)); }

        /// Whether the perturbed surface faces the viewer, who looks from wi if particles move.
        bool faces_viewer(bool sees_wi) const {
            return mode == TransportMode::radiance ? sees_wo : sees_wi;
        }

        const Interaction& at;
        Interaction bent;  ///< the same point, but for the frame
        Vector3 wo, bent_wo;
        TransportMode mode;
        bool sees_wo;           ///< wo lies on the same side in both frames
        float own_probability;  ///< of drawing from the surface's own frame
    };

    BSDFValue evaluate(const View& view, Vector3 wi) const {
        BSDFValue value;
        const Vector3 bent_wi = view.bend(wi);
        const bool sees_wi = same_hemisphere(wi, bent_wi);
        if (view.own_probability < 1 && sees_wi) {
            value = nested_.evaluate(view.bent, view.bent_wo, bent_wi, view.mode);
            value.f *= view.mode == TransportMode::radiance ? bent_wi.z / wi.z
                                                            : view.bent_wo.z / view.wo.z;
            value.pdf *= 1 - view.own_probability;
        }
        if (view.own_probability > 0) {
            const BSDFValue own = nested_.evaluate(view.at, view.wo, wi, view.mode);
            if (!view.faces_viewer(sees_wi)) value.f = own.f;
            value.pdf += own.pdf * view.own_probability;
        }
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
    static std::optional<BSDFSample> delta(const View& view, BSDFSample s, Vector3 bent_wi,
                                           bool own) {
        if (own == view.faces_viewer(same_hemisphere(s.wi, bent_wi))) return {};
        const float probability = own ? view.own_probability : 1 - view.own_probability;
        s.pdf *= probability;
        s.weight /= probability;
        if (!own && view.mode == TransportMode::importance) {
            s.weight *= view.bent_wo.z * s.wi.z / (view.wo.z * bent_wi.z);
        }
        return s;
    }

    const BSDF& nested_;
};

}  // namespace lucerna
