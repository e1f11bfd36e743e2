// SPDX-License-Identifier: Apache-2.0
/// blendphase: a mixture of two phase functions, (1 − weight) · first + weight · second.
#include "core/interfaces/phase.h"
#include "core/interfaces/volume.h"

namespace lucerna {
namespace {

class BlendPhase final : public Phase {
public:
    explicit BlendPhase(const Params& params)
        : weight_(params.volume_input("weight", Color(0.5f), unit_interval,
                                      "share of the second; a volume is cut to [0, 1]")) {
        const auto nested = params.all_nested<Phase>({2, 2}, "what is blended");
        first_ = nested[0];
        second_ = nested[1];
    }

    PhaseValue evaluate(Vector3 p, Vector3 wo, Vector3 wi) const override {
        return mixed(weight(p), first_->evaluate(p, wo, wi), second_->evaluate(p, wo, wi));
    }

    PhaseSample sample(Vector3 p, Vector3 wo, float u_lobe, Vector2 u) const override {
        const float w = weight(p);
        const bool second = u_lobe < w;
        const float rest = second ? u_lobe / w : (u_lobe - w) / (1 - w);
        const Vector3 wi =
            (second ? second_ : first_)->sample(p, wo, std::min(rest, one_minus_epsilon), u).wi;
        const PhaseValue value =
            mixed(w, first_->evaluate(p, wo, wi), second_->evaluate(p, wo, wi));
        return {.wi = wi, .weight = value.pdf > 0 ? value.f / value.pdf : 0, .pdf = value.pdf};
    }

private:
    float weight(Vector3 p) const { return std::clamp(weight_.real(p), 0.0f, 1.0f); }
    static PhaseValue mixed(float w, PhaseValue first, PhaseValue second) {
        return {.f = (1 - w) * first.f + w * second.f, .pdf = (1 - w) * first.pdf + w * second.pdf};
    }

    VolumeInput weight_;
    const Phase* first_;
    const Phase* second_;
};

}  // namespace

const PluginInfo plugin = describe<BlendPhase>("a mixture of two phase functions");

}  // namespace lucerna
