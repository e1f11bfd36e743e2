// SPDX-License-Identifier: Apache-2.0
/// null: no surface at all. Light passes straight through; the shape only bounds something.
#include "core/interfaces/bsdf.h"

namespace lucerna {
namespace {

class Null final : public BSDF {
public:
    explicit Null(const Params&) {}

    Lobe lobes() const override { return Lobe::null; }

    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }

    std::optional<BSDFSample> sample(const Interaction&, Vector3 wo, float, Vector2,
                                     TransportMode) const override {
        return BSDFSample{.wi = -wo, .weight = Color(1), .pdf = 1, .lobe = Lobe::null};
    }

    Color transmittance(const Interaction&, Vector3) const override { return Color(1); }

    Color albedo(const Interaction&, Vector3) const override { return Color(1); }
};

}  // namespace

const PluginInfo plugin = describe<Null>("no surface: light passes straight through");

}  // namespace lucerna
