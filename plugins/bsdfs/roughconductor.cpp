// SPDX-License-Identifier: Apache-2.0
/// roughconductor: a rough metal, made of tiny mirrors.
///
///     f(wo, wi) = F(wo · m) D(m) G(wo, wi) / (4 cos θo cos θi),   m = (wo + wi) / |wo + wi|
///
/// (Torrance and Sparrow 1967; Walter et al. 2007, eq. 20; Heitz 2014 for G). Normals are drawn
/// among those that wo sees. Light that would be reflected more than once between facets is lost.
#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/metal.h"
#include "plugins/bsdfs/roughness.h"

namespace lucerna {
namespace {

class RoughConductor final : public BSDF {
public:
    explicit RoughConductor(const Params& params) : roughness_(params), metal_(params) {}

    Lobe lobes() const override {
        return roughness_.lobes(Lobe::glossy_reflection, Lobe::specular_reflection);
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        const Microfacet facets = roughness_(at);
        if (!(wo.z > 0 && wi.z > 0) || facets.effectively_smooth()) return {};
        const Vector3 m = glm::normalize(wo + wi);
        const float density = 0.25f * facets.D(m);
        return {metal_.reflectance(at, glm::dot(wo, m)) * (density * facets.visibility(wo, wi)),
                density / facets.visible_area(wo)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float, Vector2 u,
                                     TransportMode mode) const override {
        if (!(wo.z > 0)) return {};
        const Microfacet facets = roughness_(at);
        if (facets.effectively_smooth()) {
            return BSDFSample{.wi = reflect(wo),
                              .weight = metal_.reflectance(at, wo.z),
                              .pdf = 1,
                              .lobe = Lobe::specular_reflection};
        }
        const Vector3 wi = reflect(wo, facets.sample_visible_normal(wo, u));
        return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return metal_.reflectance(at, wo.z);
    }

private:
    Roughness roughness_;
    Metal metal_;
};

}  // namespace

const PluginInfo plugin = describe<RoughConductor>("a rough metal");

}  // namespace lucerna
