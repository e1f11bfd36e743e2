// SPDX-License-Identifier: Apache-2.0
/// diffuse: an ideally matte surface.
///
///     f(wo, wi) = reflectance / π                                            (Lambert 1760)
///
/// Only the front reflects; `twosided` adds the back.
#include "core/base/vectorized.h"
#include "core/interfaces/bsdf.h"
#include "core/math/select.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

LUCERNA_VECTORIZED void sample_cosine(const Vector2Lanes& __restrict u,
                                      Vector3Lanes& __restrict wi) {
    for (std::size_t i = 0; i < lane_count; ++i) wi.set(i, square_to_cosine_hemisphere(u[i]));
}

LUCERNA_VECTORIZED void evaluate_cosine(const Vector3Lanes& __restrict reflectance,
                                        const FloatLanes& __restrict wo_z,
                                        const FloatLanes& __restrict wi_z,
                                        BSDFValueLanes& __restrict out) {
    for (std::size_t i = 0; i < lane_count; ++i) {
        const bool seen = wo_z[i] > 0, facing = wi_z[i] > 0;
        const bool lit = seen & facing;
        const float density = wi_z[i] * inv_pi;
        out.f.x[i] = select(lit, reflectance.x[i] * inv_pi, 0.0f);
        out.f.y[i] = select(lit, reflectance.y[i] * inv_pi, 0.0f);
        out.f.z[i] = select(lit, reflectance.z[i] * inv_pi, 0.0f);
        out.pdf[i] = select(lit, density, 0.0f);
    }
}

class Diffuse final : public BSDF {
public:
    explicit Diffuse(const Params& params)
        : reflectance_(params.color_input("reflectance", Color(0.5f), unit_interval,
                                          "fraction of light reflected")) {}

    Lobe lobes() const override { return Lobe::diffuse_reflection; }

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

    void evaluate_lanes(Batch::Points at, const LaneMask& wanted, const Vector3Lanes& wo,
                        const Vector3Lanes& wi, TransportMode, BSDFValueLanes& out) const {
        Vector3Lanes reflectance{};
        const Interaction* last = nullptr;
        Color here(0);
        for (std::size_t i = 0; i < at.size(); ++i) {
            if (!wanted[i]) continue;
            if (at[i] != last) here = reflectance_(*at[i]);
            last = at[i];
            reflectance.set(i, here);
        }
        evaluate_cosine(reflectance, wo.z, wi.z, out);
    }

    void sample_lanes(Batch::Points at, const Vector3Lanes& wo, const FloatLanes&,
                      const Vector2Lanes& u, TransportMode, BSDFSampleLanes& out) const {
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
