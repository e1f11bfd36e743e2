// SPDX-License-Identifier: Apache-2.0
/// What lights that shine from one point share: E = I(w) / d² at a distance d, along −w.
#pragma once

#include "core/interfaces/emitter.h"
#include "core/interfaces/medium.h"

namespace lucerna {

class LightPoint : public Emitter {
public:
    explicit LightPoint(const Params& params) {
        if (params.nested<Medium>("in which it lies; follows from the surfaces around it")) {
            params.warning("medium",
                           "<medium> has no effect here: light is followed from the points that it "
                           "reaches, whose medium is known");
        }
    }

    bool delta() const override { return true; }

    std::optional<LightSample> sample_li(const Light&, const Receiver& from,
                                         Vector2) const override {
        const Vector3 to_light = position_ - from.p;
        const float distance = glm::length(to_light);
        if (!(distance > 0)) return {};
        const Vector3 wi = to_light / distance;
        const Color irradiance = intensity(-wi) / (distance * distance);
        if (is_black(irradiance) || !is_finite(irradiance)) return {};
        return LightSample{.wi = wi,
                           .distance = distance,
                           .radiance = irradiance,
                           .pdf = 1,
                           .delta = true,
                           .p = position_};
    }

    float pdf_li(const Light&, const Receiver&, Vector3, const Interaction*) const override {
        return 0;
    }

protected:
    /// Along the unit vector w in the world [W/sr].
    virtual Color intensity(Vector3 w) const = 0;

    Vector3 position_{0};
};

}  // namespace lucerna
