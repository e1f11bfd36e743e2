// SPDX-License-Identifier: Apache-2.0
/// thindielectric: a thin pane, as of a window, modelled as one surface.
///
/// Light goes straight through or is reflected; with all reflections between both faces
/// R = 2F / (1 + F), T = (1 − F) / (1 + F) (Stokes 1862; pbrt 4e, 9.5.3).
#include "plugins/bsdfs/glass.h"
#include "plugins/bsdfs/ior.h"

namespace lucerna {
namespace {

class ThinDielectric final : public BSDF {
public:
    explicit ThinDielectric(const Params& params) : glass_(params, relative_ior(params, "bk7")) {}

    Lobe lobes() const override { return Lobe::specular_reflection | Lobe::null; }

    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2,
                                     TransportMode) const override {
        if (wo.z == 0) return {};
        const float reflected = reflectance(wo);
        if (u_lobe < reflected) {
            return BSDFSample{.wi = reflect(wo),
                              .weight = glass_.reflectance(at),
                              .pdf = reflected,
                              .lobe = Lobe::specular_reflection};
        }
        return BSDFSample{.wi = -wo,
                          .weight = glass_.transmittance(at),
                          .pdf = 1 - reflected,
                          .lobe = Lobe::null};
    }

    Color transmittance(const Interaction& at, Vector3 wo) const override {
        return glass_.transmittance(at) * (1 - reflectance(wo));
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        const float reflected = reflectance(wo);
        return glass_.reflectance(at) * reflected + glass_.transmittance(at) * (1 - reflected);
    }

private:
    float reflectance(Vector3 wo) const {
        const float face = fresnel_dielectric(abs_cos_theta(wo), glass_.eta);
        return 2 * face / (1 + face);
    }

    Glass glass_;
};

}  // namespace

const PluginInfo plugin = describe<ThinDielectric>("a thin pane of glass as one surface");

}  // namespace lucerna
