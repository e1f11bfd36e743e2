// SPDX-License-Identifier: Apache-2.0
/// point: light from one point, the same in all directions.
///
///   irradiance at distance d, facing the light: E = I / d²;   power: Φ = 4π I
#include "core/math/transform.h"
#include "core/math/warp.h"
#include "plugins/emitters/light_point.h"

namespace lucerna {

namespace {

class PointEmitter final : public LightPoint {
public:
    explicit PointEmitter(const Params& params)
        : LightPoint(params),
          intensity_(params.rgb("intensity", Color(1), non_negative, "radiant intensity [W/sr]")) {
        const Vector3d position = params.point("position", Vector3d(0), "where it is");
        const Transform to_world =
            params.transform("to_world", "instead of position: the point 0 is moved by it");
        if (params.has("position") && params.has("to_world")) {
            params.error("position", "give either position or to_world, not both");
        }
        position_ = Vector3(to_world.point(position));
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
    }

    std::optional<EmissionSample> sample_emission(const Light&, Vector2,
                                                  Vector2 u_direction) const override {
        const Vector3 w = square_to_uniform_sphere(u_direction);
        return EmissionSample{.ray = {.o = position_, .d = w},
                              .power = 4 * pi * intensity_,
                              .pdf_position = 1,
                              .pdf_direction = square_to_uniform_sphere_pdf(w)};
    }

    LightBounds bounds(const Light&) const override {
        return {.box = {.min = position_, .max = position_},
                .power = 4 * std::numbers::pi * static_cast<double>(luminance(intensity_))};
    }

private:
    Color intensity(Vector3) const override { return intensity_; }

    Color intensity_;
};

}  // namespace

const PluginInfo plugin = describe<PointEmitter>("light from a point");

}  // namespace lucerna
