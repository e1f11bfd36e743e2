// SPDX-License-Identifier: Apache-2.0
/// mask: makes a BSDF partly transparent; light passes straight through with 1 − opacity.
///
///     f(wo, wi) = opacity · nested(wo, wi) + (1 − opacity) δ(wi + wo) / |cos θi|
#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"

namespace lucerna {
namespace {

class Mask final : public BSDF {
public:
    explicit Mask(const Params& params)
        : opacity_(params.float_input("opacity", 0.5f, unit_interval, "1: nothing shines through")),
          nested_(*params.all_nested<BSDF>({1, 1}, "what is there where it is opaque").front()) {}

    Lobe lobes() const override {
        const bool opaque = !opacity_.texture && opacity_.constant == 1;
        return opaque ? nested_.lobes() : nested_.lobes() | Lobe::null;
    }

    BSDFValue evaluate(const Interaction& at, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        const float opaque = opacity(at);
        const BSDFValue value = nested_.evaluate(at, wo, wi, mode);
        return {value.f * opaque, value.pdf * opaque};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float u_lobe, Vector2 u,
                                     TransportMode mode) const override {
        const float opaque = opacity(at);
        if (!(u_lobe < opaque)) {
            return BSDFSample{.wi = -wo, .weight = Color(1), .pdf = 1 - opaque, .lobe = Lobe::null};
        }
        std::optional<BSDFSample> s = nested_.sample(at, wo, rescaled(u_lobe, 0, opaque), u, mode);
        if (s) s->pdf *= opaque;
        return s;
    }

    Color transmittance(const Interaction& at, Vector3 wo) const override {
        return glm::mix(Color(1), nested_.transmittance(at, wo), opacity(at));
    }

    Color albedo(const Interaction& at, Vector3 wo) const override {
        return glm::mix(Color(1), nested_.albedo(at, wo), opacity(at));
    }

private:
    float opacity(const Interaction& at) const { return std::clamp(opacity_(at), 0.0f, 1.0f); }

    FloatInput opacity_;
    const BSDF& nested_;
};

}  // namespace

const PluginInfo plugin = describe<Mask>("a BSDF with holes");

}  // namespace lucerna
