// SPDX-License-Identifier: Apache-2.0
/// toon: a diffuse surface that is lit in flat bands, as in a cartoon.
///
/// What a light adds to the surface does not grow smoothly with c = cos θi, but in `bands` equal
/// steps from 0 to 1:
///
///     q(c) = k / (bands − 1)  for  k / bands <= c < (k + 1) / bands
///     f(wo, wi) = reflectance / π · q(cos θi) / cos θi
///
/// One small light shows the bands sharply, a large one softens them. The bands keep the energy of
/// a diffuse surface: ∫ q dω = π for any number of them, so that the reflected fraction is the
/// reflectance. But f is not reciprocal, which no real surface can be: particles that come from the
/// lights (TransportMode::importance) therefore meet f with its directions exchanged (Veach 1997,
/// chapter 5), and photon mapping and path tracing agree.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"

namespace lucerna {
namespace {

class ToonBSDF final : public BSDF {
public:
    explicit ToonBSDF(const Params& params)
        : reflectance_(params.color_input("reflectance", Color(0.5f), unit_interval,
                                          "fraction of light reflected")),
          bands_(params.int32("bands", 3, {.min = 2, .max = 64}, "number of flat bands")) {}

    Lobe lobes() const override { return Lobe::diffuse_reflection; }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        if (cos_theta(wo) <= 0 || cos_theta(wi) <= 0) return {};
        const Color rho = reflectance_(at);
        if (mode == TransportMode::importance) {
            return {rho * inv_pi * (level(wo) / cos_theta(wo)),
                    square_to_cosine_hemisphere_pdf(wi)};
        }
        return {rho * inv_pi * (level(wi) / cos_theta(wi)), level(wi) * inv_pi};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (cos_theta(wo) <= 0) return {};
        BSDFSample result{.lobe = Lobe::diffuse_reflection};
        const Color rho = reflectance_(at);
        if (mode == TransportMode::importance) {
            result.wi = square_to_cosine_hemisphere(u);
            result.pdf = square_to_cosine_hemisphere_pdf(result.wi);
            result.weight = rho * (level(wo) / cos_theta(wo));
        } else {
            result.wi = sample_band(u_lobe, u);
            result.pdf = level(result.wi) * inv_pi;
            result.weight = rho;
        }
        if (result.pdf <= 0) return {};
        return result;
    }

    Color albedo(const Interaction& at, Vector3) const override { return reflectance_(at); }

private:
    int band(Vector3 w) const {
        const auto bands = static_cast<float>(bands_);
        return std::min(static_cast<int>(cos_theta(w) * bands), bands_ - 1);
    }

    /// q(cos θ) in [0, 1].
    float level(Vector3 w) const {
        return static_cast<float>(band(w)) / static_cast<float>(bands_ - 1);
    }

    /// A direction with density q / π. The probability of band k is proportional to k, so that of
    /// all bands up to k is k (k + 1) / (bands (bands − 1)); within a band, all directions are
    /// equally likely, and with them all cosines (Archimedes).
    Vector3 sample_band(float u_lobe, Vector2 u) const {
        const auto bands = static_cast<float>(bands_);
        const float target = u_lobe * bands * (bands - 1);
        float k = 1;
        while (k < bands - 1 && k * (k + 1) <= target) ++k;
        const float cosine = std::min((k + u.x) / bands, 1.0f);
        const Vector2 circle = safe_sqrt(1 - cosine * cosine) * unit_circle(u.y);
        return {circle.x, circle.y, cosine};
    }

    ColorInput reflectance_;
    int bands_;
};

}  // namespace

const PluginInfo plugin = describe<ToonBSDF>("a diffuse surface lit in flat bands");

}  // namespace lucerna
