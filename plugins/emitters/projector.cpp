// SPDX-License-Identifier: Apache-2.0
/// projector: throws a picture from a point, as a pinhole camera would take it.
///
/// The picture lies on the plane z = 1 of the light's space, with its left side at +x and its upper
/// edge at +y, as the image of a camera. A plane of constant z that faces the light receives the
/// irradiance π T / z², with the picture's T times `scale`, as in Mitsuba. Hence the intensity
/// π T / cos³ θ, and the flux π A T̄ with the picture's area A on the plane z = 1.
#include "core/math/orientation.h"
#include "core/plugin/field_of_view.h"
#include "plugins/emitters/light_point.h"

namespace lucerna {

namespace {

class Projector final : public LightPoint {
public:
    explicit Projector(const Params& params)
        : LightPoint(params),
          picture_(params.color_input("irradiance", Color(1), non_negative, "the picture")),
          scale_(params.real("scale", 1, non_negative, "factor of the picture")) {
        const double aspect =
            picture_.texture ? static_cast<double>(picture_.texture->aspect()) : 1.0;
        const double half_width = half_width_at_unit_depth(params, aspect);
        half_ = Vector2(Vector2d(half_width, half_width / aspect));
        const Transform to_world =
            params.transform("to_world", "moves the light from 0 and turns it from the z axis");
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
        const std::optional<Frame> frame = orientation(to_world);
        if (!frame) params.error("to_world", "\"to_world\" of a projector must not stretch space");
        frame_ = frame.value_or(Frame());
        position_ = Vector3(to_world.point(Vector3d(0)));
    }

    std::optional<EmissionSample> sample_emission(const Light&, Vector2,
                                                  Vector2 u_direction) const override {
        const Vector2 at = (1.0f - 2.0f * u_direction) * half_;
        const float length = std::sqrt(1 + glm::dot(at, at));
        const Vector3 local = Vector3(at, 1) / length;
        return EmissionSample{.ray = {.o = position_, .d = frame_.to_world(local)},
                              .power = value(at) * area(),
                              .pdf_position = 1,
                              .pdf_direction = length * length * length / area()};
    }

    LightBounds bounds(const Light&) const override {
        const float corner = std::sqrt(1 + glm::dot(half_, half_));
        return {.box = {.min = position_, .max = position_},
                .axis = frame_.n,
                .cos_normals = 1 / corner,
                .cos_emission = 1,
                .power = static_cast<double>(pi * scale_ * area() * luminance(picture_.mean()))};
    }

private:
    float area() const { return 4 * half_.x * half_.y; }

    /// π T at a point of the plane z = 1.
    Color value(Vector2 at) const {
        const Vector2 uv(0.5f - 0.5f * at.x / half_.x, 0.5f + 0.5f * at.y / half_.y);
        return pi * scale_ * (picture_.texture ? picture_.texture->color(uv) : picture_.constant);
    }

    Color intensity(Vector3 w) const override {
        const Vector3 local = frame_.to_local(w);
        if (!(local.z > 0)) return Color(0);
        const Vector2 at = Vector2(local) / local.z;
        if (std::abs(at.x) > half_.x || std::abs(at.y) > half_.y) return Color(0);
        return value(at) / (local.z * local.z * local.z);
    }

    ColorInput picture_;
    float scale_;
    Vector2 half_{1};  ///< half of the width and of the height at z = 1
    Frame frame_;
};

}  // namespace

const PluginInfo plugin = describe<Projector>("throws a picture from a point");

}  // namespace lucerna
