// SPDX-License-Identifier: Apache-2.0
/// A diffuse BSDF whose density is 2 % too low, in `sample` and `evaluate` alike: pictures are 2 %
/// too bright where it is seen by multiple importance sampling.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class WrongDensity final : public BSDF {
public:
    explicit WrongDensity(const Params&) {}

    Lobe lobes() const override { return Lobe::diffuse_reflection; }

    BSDFValue evaluate(const Interaction&, Vector3 wo, Vector3 wi, TransportMode) const override {
        if (cos_theta(wo) <= 0 || cos_theta(wi) <= 0) return {};
        return {Color(0.5f * inv_pi), density(wi)};
    }

    std::optional<BSDFSample> sample(const Interaction&, Vector3 wo, float, Vector2 u,
                                     TransportMode) const override {
        if (cos_theta(wo) <= 0) return {};
        const Vector3 wi = square_to_cosine_hemisphere(u);
        return BSDFSample{.wi = wi,
                          .weight = Color(0.5f / 0.98f),
                          .pdf = density(wi),
                          .lobe = Lobe::diffuse_reflection};
    }

    Color albedo(const Interaction&, Vector3) const override { return Color(0.5f); }

private:
    static float density(Vector3 wi) { return 0.98f * square_to_cosine_hemisphere_pdf(wi); }
};

}  // namespace

const PluginInfo plugin = describe<WrongDensity>("has a density that is 2 % too low");

}  // namespace lucerna
