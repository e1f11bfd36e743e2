// SPDX-License-Identifier: Apache-2.0
/// twosided: gives an opaque BSDF, which scatters at its front only, a back.
///
/// One nested BSDF serves both sides; of two, the first is for the front.
#include "core/interfaces/bsdf.h"

namespace lucerna {
namespace {

class TwoSided final : public BSDF {
public:
    explicit TwoSided(const Params& params) {
        const auto nested = params.all_nested<BSDF>({1, 2}, "opaque; the second is for the back");
        front_ = nested.front();
        back_ = nested.back();
        if (any(lobes() & transmission_lobes)) {
            throw Error(
                "twosided cannot hold a BSDF that transmits light: it has two sides "
                "already; use it without twosided");
        }
    }

    Lobe lobes() const override { return front_->lobes() | back_->lobes(); }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        if (wo.z >= 0) return front_->evaluate(at, wo, wi, mode);
        return back_->evaluate(at, flipped(wo), flipped(wi), mode);
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        if (wo.z >= 0) return front_->sample(at, wo, u_lobe, u, mode);
        std::optional<BSDFSample> s = back_->sample(at, flipped(wo), u_lobe, u, mode);
        if (s) s->wi = flipped(s->wi);
        return s;
    }

    void evaluate_lanes(Batch::Points at, const LaneMask& wanted, const Vector3Lanes& wo,
                        const Vector3Lanes& wi, TransportMode mode, BSDFValueLanes& out) const {
        if (front_ != back_) {
            return Batch::evaluate_one_by_one(*this, at, wanted, wo, wi, mode, out);
        }
        Vector3Lanes front_wo = wo, front_wi = wi;
        flip_where_behind(wo.z, front_wo.z);
        flip_where_behind(wo.z, front_wi.z);
        front_->batch().evaluate(*front_, at, wanted, front_wo, front_wi, mode, out);
    }

    void sample_lanes(Batch::Points at, const Vector3Lanes& wo, const FloatLanes& u_lobe,
                      const Vector2Lanes& u, TransportMode mode, BSDFSampleLanes& out) const {
        if (front_ != back_) {
            return Batch::sample_one_by_one(*this, at, wo, u_lobe, u, mode, out);
        }
        Vector3Lanes front_wo = wo;
        flip_where_behind(wo.z, front_wo.z);
        front_->batch().sample(*front_, at, front_wo, u_lobe, u, mode, out);
        flip_where_behind(wo.z, out.wi.z);
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return wo.z >= 0 ? front_->albedo(at, wo) : back_->albedo(at, flipped(wo));
    }

private:
    static void flip_where_behind(const FloatLanes& wo_z, FloatLanes& z) {
        for (std::size_t i = 0; i < lane_count; ++i) z[i] = wo_z[i] >= 0 ? z[i] : -z[i];
    }
    static Vector3 flipped(Vector3 w) { return {w.x, w.y, -w.z}; }

    const BSDF* front_;
    const BSDF* back_;
};

}  // namespace

const PluginInfo plugin = describe<TwoSided>("the same or two BSDFs on both sides of a surface");

}  // namespace lucerna
