// SPDX-License-Identifier: Apache-2.0
/// dielectric: a perfectly smooth boundary between two transparent substances, as glass or water.
///
/// The fraction F (Fresnel) is reflected, the rest refracted by Snell's law; radiance is scaled by
/// 1 / η² as it enters (pbrt 4e, 9.5). `int_ior` holds on the side the normals point away from.
#include "plugins/bsdfs/glass.h"
#include "plugins/bsdfs/ior.h"

namespace lucerna {
namespace {

class Dielectric final : public BSDF {
public:
    explicit Dielectric(const Params& params) : glass_(params, relative_ior(params, "bk7")) {}

    Lobe lobes() const override {
        return glass_.matched() ? Lobe::null
                                : Lobe::specular_reflection | Lobe::specular_transmission;
    }

    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2,
                                     TransportMode mode) const override {
        return glass_.sample_smooth(at, wo, u_lobe, mode);
    }

    Color transmittance(const Interaction& at, Vector3) const override {
        return glass_.straight(at);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return glass_.albedo(at, wo.z);
    }

private:
    Glass glass_;
};

}  // namespace

const PluginInfo plugin = describe<Dielectric>("a smooth transparent substance, as glass");

}  // namespace lucerna
