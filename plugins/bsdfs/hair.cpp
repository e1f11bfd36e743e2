// SPDX-License-Identifier: Apache-2.0
/// hair: light in a rough, absorbing fibre (Chiang et al. 2016, "A Practical and Controllable Hair
/// and Fur Model for Production Path Tracing"; Pharr 2016, "The Implementation of a Hair Scattering
/// Model", whose formulas these are).
///
/// For round curves, whose local y axis runs along the fibre, from the root to the tip. Light is
/// reflected (p = 0), goes through (1), or is reflected p − 1 times inside:
///
///     f(wo, wi) |cos θ| = Σ M_p(θo, θi) A_p(θo, h) N_p(φ)
///
/// θ is the angle to the plane across the fibre, φ the azimuth around it, h = sin γ the offset at
/// which wo meets the cross-section. The lobes stand for all that happens in the fibre: where light
/// is seen to leave it, it is taken to have entered. So particles spread as radiance does, which is
/// the adjoint over the width of a fibre, not in each of its points. Nothing is seen from inside.
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/hair_lobes.h"
#include "plugins/bsdfs/ior.h"

#include "core/math/fresnel.h"

namespace lucerna {
namespace {

constexpr int last_lobe = 3;  ///< stands for all from p = 3 on

class Hair final : public BSDF {
public:
    explicit Hair(const Params& params) : eta_(relative_ior(params, "amber")) {
        constexpr Range roughness{.min = 0.01, .max = 1};
        const auto along = static_cast<double>(params.real(
            "longitudinal_roughness", 0.3, roughness, "along the fibre, as artists measure it"));
        const auto around = static_cast<double>(
            params.real("azimuthal_roughness", 0.3, roughness, "around the fibre"));
        const auto tilt = static_cast<double>(params.real("scale_tilt", 2, {.min = -90, .max = 90},
                                                          "angle of the scales to the fibre [°]"));
        read_absorption(params);
        // Fits of Chiang et al. (2016), eq. 7 and 8.
        const double v = sqr(0.726 * along + 0.812 * sqr(along) + 3.7 * std::pow(along, 20));
        variance_ = {v, 0.25 * v, 4 * v, 4 * v};
        scale_ = std::sqrt(std::numbers::pi / 8) *
                 (0.265 * around + 1.194 * sqr(around) + 5.372 * std::pow(around, 22));
        const double alpha = tilt * std::numbers::pi / 180;
        tilt_ = {2 * alpha, -alpha, -4 * alpha, 0};
    }

    Lobe lobes() const override { return Lobe::glossy_reflection | Lobe::glossy_transmission; }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        if (!(wo.z > 0) || wi.z == 0) return {};
        const Fibre fibre(*this, at, wo);
        const double azimuth =
            std::atan2(static_cast<double>(wi.x), static_cast<double>(wi.z)) - fibre.gamma_o;
        const double sin_i = static_cast<double>(wi.y);
        ColorD value(0);
        double pdf = 0;
        for (std::size_t p = 0; p <= last_lobe; ++p) {
            const double m = longitudinal(sin_i, fibre.tilted[p], variance_[p]);
            const double n = p < last_lobe ? azimuthal(azimuth - fibre.exit_angle(p), scale_)
                                           : 1 / (2 * std::numbers::pi);
            value += ColorD(fibre.attenuation[p]) * (m * n);
            pdf += fibre.probability[p] * (m * n);
        }
        const Color f = Color(value) / abs_cos_theta(wi);
        if (!(pdf > 0) || !is_finite(f)) return {};
        return {f, static_cast<float>(pdf)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (!(wo.z > 0)) return {};
        const Fibre fibre(*this, at, wo);
        std::size_t p = 0;
        float before = 0, after = static_cast<float>(fibre.probability[0]);
        while (p < last_lobe && !(u_lobe < after)) {
            before = after;
            after += static_cast<float>(fibre.probability[++p]);
        }
        const auto rest = static_cast<double>(std::max(
            after > before ? rescaled(u_lobe, before, std::max(after, u_lobe)) : 0.0f, 0.0f));
        const Vector2d v(u);
        const double sin_i = sample_longitudinal(v, fibre.tilted[p], variance_[p]);
        const double turn = p < last_lobe ? fibre.exit_angle(p) + sample_azimuthal(rest, scale_)
                                          : 2 * std::numbers::pi * rest;
        const double azimuth = fibre.gamma_o + turn, cos_i = std::sqrt(1 - sqr(sin_i));
        const Vector3 wi(Vector3d(cos_i * std::sin(azimuth), sin_i, cos_i * std::cos(azimuth)));
        return drawn(*this, at, wo, wi, mode,
                     wi.z > 0 ? Lobe::glossy_reflection : Lobe::glossy_transmission);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        if (!(wo.z > 0)) return Color(0);
        const Fibre fibre(*this, at, wo);
        Color sum(0);
        for (const Color& a : fibre.attenuation) sum += a;
        return glm::min(sum, Color(1));
    }

private:
    /// What depends on the point and on wo alone.
    struct Fibre {
        Fibre(const Hair& hair, const Interaction& at, Vector3 wo) {
            const double sin_o = std::clamp(static_cast<double>(wo.y), -1.0, 1.0);
            const double cos_o = std::sqrt(1 - sqr(sin_o));
            const auto eta = static_cast<double>(hair.eta_);
            gamma_o = std::atan2(static_cast<double>(wo.x), static_cast<double>(wo.z));
            // The index that makes Snell's law hold in the projection (Bravais).
            const double bravais = std::sqrt(std::max(sqr(eta) - sqr(sin_o), 0.0)) / cos_o;
            const double sin_gamma_t = std::clamp(std::sin(gamma_o) / bravais, -1.0, 1.0);
            gamma_t = std::asin(sin_gamma_t);
            const double cos_t = std::sqrt(std::max(1 - sqr(sin_o / eta), 1e-12));
            const double path = 2 * std::sqrt(1 - sqr(sin_gamma_t)) / cos_t;  // in radii
            const Color through = glm::exp(-hair.absorption(at) * static_cast<float>(path));
            const float f =
                fresnel_dielectric(static_cast<float>(cos_o * std::cos(gamma_o)), hair.eta_);
            attenuation[0] = Color(f);
            attenuation[1] = sqr(1 - f) * through;
            attenuation[2] = attenuation[1] * through * f;
            attenuation[3] = attenuation[2] * through * f / glm::max(1.0f - through * f, 1e-6f);
            double total = 0;
            for (std::size_t p = 0; p <= last_lobe; ++p) {
                tilted[p] = std::sin(std::asin(sin_o) - hair.tilt_[p]);
                probability[p] = static_cast<double>(luminance(attenuation[p]));
                total += probability[p];
            }
            for (double& p : probability) p /= total;
        }

        /// Azimuth of a ray that leaves a smooth fibre, relative to wo.
        double exit_angle(std::size_t p) const {
            const auto number = static_cast<double>(p);
            return 2 * number * gamma_t - 2 * gamma_o + number * std::numbers::pi;
        }

        double gamma_o, gamma_t;
        std::array<Color, last_lobe + 1> attenuation;
        std::array<double, last_lobe + 1> probability, tilted;  ///< sines of tilted angles
    };

    void read_absorption(const Params& params) {
        sigma_a_ = params.color_input("sigma_a", Color(0), non_negative,
                                      "absorption over the radius of the fibre, instead of "
                                      "pigments");
        const float eumelanin = params.real("eumelanin", 1.3, non_negative,
                                            "concentration of the brown and black pigment");
        const float pheomelanin = params.real("pheomelanin", 0.2, non_negative,
                                              "concentration of the red and yellow pigment");
        scale_absorption_ = params.real("scale", 1, non_negative, "factor of the absorption");
        const bool pigments = params.has("eumelanin") || params.has("pheomelanin");
        if (pigments && params.has("sigma_a")) {
            params.error("sigma_a", "give either sigma_a or pigments, not both");
        }
        if (params.has("sigma_a")) return;
        // d'Eon et al. 2011, as fitted to RGB by Pharr (2016).
        sigma_a_.constant =
            eumelanin * Color(0.419f, 0.697f, 1.37f) + pheomelanin * Color(0.187f, 0.4f, 1.05f);
    }

    Color absorption(const Interaction& at) const {
        return scale_absorption_ * glm::max(sigma_a_(at), Color(0));
    }

    float eta_;
    ColorInput sigma_a_;
    float scale_absorption_ = 1;
    std::array<double, last_lobe + 1> variance_{}, tilt_{};  ///< tilts [rad]
    double scale_ = 0;                                       ///< of the logistic distribution
};

}  // namespace

const PluginInfo plugin = describe<Hair>("a fibre of hair or fur, for curves");

}  // namespace lucerna
