// SPDX-License-Identifier: Apache-2.0
/// blendphase: a mixture of two kinds of particles with the phase functions f1 and f2, of which
/// `weight` is the share of the second.
///
///     σ = (1 − weight) σ1 + weight σ2      f = ((1 − weight) σ1 f1 + weight σ2 f2) / σ
///
/// The projected areas σ are 1 unless particles are oriented.
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
        oriented_ = first_->oriented() || second_->oriented();
    }

    PhaseValue evaluate(Vector3 p, Vector3 wo, Vector3 wi) const override {
        return mixed(weight(p, wo), first_->evaluate(p, wo, wi), second_->evaluate(p, wo, wi));
    }

    PhaseSample sample(Vector3 p, Vector3 wo, float u_lobe, Vector2 u) const override {
        const float w = weight(p, wo);
        const bool second = u_lobe < w;
        const float rest = second ? u_lobe / w : (u_lobe - w) / (1 - w);
        const Vector3 wi =
            (second ? second_ : first_)->sample(p, wo, std::min(rest, one_minus_epsilon), u).wi;
        const PhaseValue value =
            mixed(w, first_->evaluate(p, wo, wi), second_->evaluate(p, wo, wi));
        return {.wi = wi, .weight = value.pdf > 0 ? value.f / value.pdf : 0, .pdf = value.pdf};
    }

    bool oriented() const override { return oriented_; }
    bool uniform() const override {
        return !oriented_ || (!weight_.volume && first_->uniform() && second_->uniform());
    }
    float projected_area(Vector3 p, Vector3 w) const override {
        const float second = share(p);
        return (1 - second) * first_->projected_area(p, w) + second * second_->projected_area(p, w);
    }
    float max_projected_area(const Bounds3& box) const override {
        return std::max(first_->max_projected_area(box), second_->max_projected_area(box));
    }

private:
    /// Share of the second kind in the density.
    float share(Vector3 p) const { return std::clamp(weight_.real(p), 0.0f, 1.0f); }
    /// Its share in what is seen along wo.
    float weight(Vector3 p, Vector3 wo) const {
        const float w = share(p);
        if (!oriented_) return w;
        const float first = (1 - w) * first_->projected_area(p, wo);
        const float second = w * second_->projected_area(p, wo);
        return first + second > 0 ? second / (first + second) : w;
    }
    static PhaseValue mixed(float w, PhaseValue first, PhaseValue second) {
        return {.f = (1 - w) * first.f + w * second.f, .pdf = (1 - w) * first.pdf + w * second.pdf};
    }

    VolumeInput weight_;
    const Phase* first_;
    const Phase* second_;
    bool oriented_;
};

}  // namespace

const PluginInfo plugin = describe<BlendPhase>("a mixture of two phase functions");

}  // namespace lucerna
