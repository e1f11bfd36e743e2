// SPDX-License-Identifier: Apache-2.0
/// conductor: a perfectly smooth metal.
///
///     f(wo, wi) = specular_reflectance · F(cos θo) δ(wi − reflect(wo)) / |cos θi|  (pbrt 4e, 9.4)
///
/// with the Fresnel reflectance F of a complex index of refraction. Only the front reflects.
#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/metal.h"

namespace lucerna {
namespace {

class Conductor final : public BSDF {
public:
    explicit Conductor(const Params& params) : metal_(params) {}

    Lobe lobes() const override { return Lobe::specular_reflection; }

    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float, Vector2,
                                     TransportMode) const override {
        if (!(wo.z > 0)) return {};
        return BSDFSample{.wi = reflect(wo),
                          .weight = metal_.reflectance(at, wo.z),
                          .pdf = 1,
                          .lobe = Lobe::specular_reflection};
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return metal_.reflectance(at, wo.z);
    }

private:
    Metal metal_;
};

}  // namespace

const PluginInfo plugin = describe<Conductor>("a perfectly smooth metal");

}  // namespace lucerna
