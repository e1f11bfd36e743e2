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

LUCERNA_VECTORIZED void sample_cosine(const Vector2Lanes& __restrict u,
                                      Vector3Lanes& __restrict wi) {
    for (std::size_t i = 0; i < lane_count; ++i) wi.set(i, square_to_cosine_hemisphere(u[i]));
}

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
        return {reflectance_(at) * inv_pi, square_to_cosine_hemisphere_pdf(wi)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float, Vector2 u,
                                     TransportMode) const override {
        if (!(wo.z > 0)) return {};
        const Vector3 wi = square_to_cosine_hemisphere(u);
        return BSDFSample{.wi = wi,
                          .weight = reflectance_(at),
                          .pdf = square_to_cosine_hemisphere_pdf(wi),
                          .lobe = Lobe::diffuse_reflection};
    }

    void sample_lanes(std::span<const Interaction* const> at, const Vector3Lanes& wo,
                      const FloatLanes&, const Vector2Lanes& u, TransportMode,
                      BSDFSampleLanes& out) const override {
        sample_cosine(u, out.wi);
        for (std::size_t i = 0; i < at.size(); ++i) {
            out.weight.set(i, reflectance_(*at[i]));
            out.lobe[i] = wo.z[i] > 0 ? Lobe::diffuse_reflection : Lobe::none;
        }
    }

    Color albedo(const Interaction& at, Vector3) const override { return reflectance_(at); }

private:
    ColorInput reflectance_;
};

}  // namespace

const PluginInfo plugin = describe<Diffuse>("an ideally matte surface");

}  // namespace lucerna
