// SPDX-License-Identifier: Apache-2.0
/// diffuse: an ideally matte surface.
///
///     f(wo, wi) = reflectance / π                                            (Lambert 1760)
///
/// Only the front reflects; `twosided` adds the back.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class Diffuse final : public BSDF {
public:
    explicit Diffuse(const Params& params)
        : reflectance_(params.color_input("reflectance", Color(0.5f), unit_interval,
                                          "fraction of light reflected")) {}

    Lobe lobes() const override { return Lobe::diffuse_reflection; }
    bool uses_tangents() const override { return false; }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        return {reflectance_(at.uv) * inv_pi, square_to_cosine_hemisphere_pdf(wi)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float, Vector2 u,
                                     TransportMode) const override {
        if (!(wo.z > 0)) return {};
        const Vector3 wi = square_to_cosine_hemisphere(u);
        return BSDFSample{.wi = wi,
                          .weight = reflectance_(at.uv),
                          .pdf = square_to_cosine_hemisphere_pdf(wi),
                          .lobe = Lobe::diffuse_reflection};
    }

    Color albedo(const Interaction& at, Vector3) const override { return reflectance_(at.uv); }

private:
    ColorInput reflectance_;
};

}  // namespace

const PluginInfo plugin = describe<Diffuse>("an ideally matte surface");

}  // namespace lucerna
