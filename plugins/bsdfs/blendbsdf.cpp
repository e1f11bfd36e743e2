// SPDX-License-Identifier: Apache-2.0
/// blendbsdf: a mixture of two BSDFs.
///
///     f = (1 − weight) · first + weight · second
#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"

namespace lucerna {
namespace {

class BlendBSDF final : public BSDF {
public:
    explicit BlendBSDF(const Params& params)
        : weight_(params.float_input("weight", 0.5f, unit_interval,
                                     "0: only the first BSDF; 1: only the second")) {
        const auto nested = params.all_nested<BSDF>({2, 2}, "the first and the second");
        first_ = nested.front();
        second_ = nested.back();
    }

    Lobe lobes() const override { return first_->lobes() | second_->lobes(); }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        const float w = weight(at);
        const BSDFValue a = first_->evaluate(at, wo, wi, mode);
        const BSDFValue b = second_->evaluate(at, wo, wi, mode);
        return {glm::mix(a.f, b.f, w), (1 - w) * a.pdf + w * b.pdf};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        const float w = weight(at);
        const bool second = u_lobe < w;
        const float u_nested = second ? rescaled(u_lobe, 0, w) : rescaled(u_lobe, w, 1);
        std::optional<BSDFSample> s =
            (second ? second_ : first_)->sample(at, wo, u_nested, u, mode);
        if (!s) return {};
        if (!s->specular()) return drawn(*this, at, wo, s->wi, mode, s->lobe, s->eta);
        s->pdf *= second ? w : 1 - w;
        return s;
    }

    Color transmittance(const Interaction& at, Vector3 wo) const override {
        return glm::mix(first_->transmittance(at, wo), second_->transmittance(at, wo), weight(at));
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return glm::mix(first_->albedo(at, wo), second_->albedo(at, wo), weight(at));
    }

private:
    float weight(const Interaction& at) const { return std::clamp(weight_(at), 0.0f, 1.0f); }

    FloatInput weight_;
    const BSDF* first_;
    const BSDF* second_;
};

}  // namespace

const PluginInfo plugin = describe<BlendBSDF>("a mixture of two BSDFs");

}  // namespace lucerna
