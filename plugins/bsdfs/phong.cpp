// SPDX-License-Identifier: Apache-2.0
/// phong: the modified Phong model, for old scenes.
///
///     f(wo, wi) = kd / π + ks (n + 2) / (2π) max(cos α, 0)ⁿ
///
/// where α is the angle between wi and the mirror direction of wo (Lafortune and Willems 1994,
/// "Using the Modified Phong Reflectance Model for Physically Based Rendering"). kd + ks must not
/// exceed 1, else both are scaled down. Prefer roughplastic.
#include "core/interfaces/bsdf.h"
#include "core/math/warp.h"
#include "plugins/bsdfs/draw.h"

namespace lucerna {
namespace {

class Phong final : public BSDF {
public:
    explicit Phong(const Params& params)
        : exponent_(params.float_input("exponent", 30, non_negative, "larger: sharper highlights")),
          diffuse_(params.color_input("diffuse_reflectance", Color(0.5f), unit_interval,
                                      "fraction of light reflected diffusely")),
          specular_(params.color_input("specular_reflectance", Color(0.2f), unit_interval,
                                       "fraction of light reflected into the highlight")) {
        const float largest = diffuse_.max() + specular_.max();
        if (largest > 1) {
            scale_ = 1 / largest;
            params.warning("specular_reflectance",
                           "diffuse_reflectance and specular_reflectance add up to more than 1: "
                           "both are scaled down to conserve energy");
        }
        const float specular = luminance(specular_.mean()), diffuse = luminance(diffuse_.mean());
        if (specular > 0) specular_share_ = specular / (specular + diffuse);
    }

    Lobe lobes() const override { return Lobe::diffuse_reflection | Lobe::glossy_reflection; }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode) const override {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const float n = exponent_(at);
        const float cos_alpha = glm::dot(reflect(wo), wi);
        const float lobe = cos_alpha > 0 ? std::pow(cos_alpha, n) * (0.5f * inv_pi) : 0.0f;
        return {scale_ * (diffuse_(at) * inv_pi + specular_(at) * ((n + 2) * lobe)),
                glm::mix(square_to_cosine_hemisphere_pdf(wi), (n + 1) * lobe, specular_share_)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (!(wo.z > 0)) return {};
        if (!(u_lobe < specular_share_)) {
            const Vector3 wi = square_to_cosine_hemisphere(u);
            return drawn(*this, at, wo, wi, mode, Lobe::diffuse_reflection);
        }
        const float cos_alpha = std::pow(1 - u.x, 1 / (exponent_(at) + 1));
        const Vector2 side = safe_sqrt((1 - cos_alpha) * (1 + cos_alpha)) * unit_circle(u.y);
        const Frame lobe = Frame::from_normal(reflect(wo));
        const Vector3 wi = glm::normalize(lobe.to_world({side.x, side.y, cos_alpha}));
        return drawn(*this, at, wo, wi, mode, Lobe::glossy_reflection);
    }

    Color albedo(const Interaction& at, Vector3) const override {
        return scale_ * (diffuse_(at) + specular_(at));
    }

private:
    FloatInput exponent_;
    ColorInput diffuse_, specular_;
    float scale_ = 1;
    float specular_share_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<Phong>("the modified Phong model, for old scenes");

}  // namespace lucerna
