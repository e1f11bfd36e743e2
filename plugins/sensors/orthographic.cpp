// SPDX-License-Identifier: Apache-2.0
/// orthographic: parallel rays, no perspective.
///
/// The film sees [−1, 1] × [−h/w, h/w] of the xy plane of camera space, along +z; to_world makes
/// it larger: `<scale value="10"/>` before the `<lookat>`.
#include "plugins/sensors/projective.h"

namespace lucerna {

namespace {

class OrthographicCamera final : public ProjectiveSensor {
public:
    explicit OrthographicCamera(const Params& params) : ProjectiveSensor(params) {
        params.no_effect("focus_distance", "it is sharp everywhere");
        const Vector2d size(film().size());
        const Transform& to_world = world_from_camera();
        // x to the left and y up.
        corner_ = Vector3(to_world.point(Vector3d(1, size.y / size.x, 0)));
        per_column_ = Vector3(to_world.direction(Vector3d(-2 / size.x, 0, 0)));
        per_row_ = Vector3(to_world.direction(Vector3d(0, -2 / size.x, 0)));
        view_ = Vector3(glm::normalize(to_world.direction(Vector3d(0, 0, 1))));
    }

    Ray sample_ray(Vector2 position, Vector2) const override {
        return clipped(corner_ + position.x * per_column_ + position.y * per_row_, view_, 1);
    }

    std::optional<SensorConnection> connect(Vector3 p, Vector2) const override {
        // Solves column · a + row · b + view · depth = p − corner (Cramer's rule).
        const Vector3 normal = glm::cross(per_column_, per_row_);
        const float volume = glm::dot(normal, view_);
        const Vector3 d = p - corner_;
        const float depth = glm::dot(normal, d) / volume;
        if (volume == 0 || !in_depth_range(depth)) return {};
        const Vector2 position(glm::dot(d, glm::cross(per_row_, view_)) / volume,
                               glm::dot(d, glm::cross(view_, per_column_)) / volume);
        return SensorConnection{.position = position,
                                .p = p - (depth - near_clip()) * view_,
                                .wi = -view_,
                                .distance = depth - near_clip(),
                                .importance = 1 / std::abs(volume)};
    }

private:
    Vector3 corner_, per_column_, per_row_;  ///< upper left corner of the film, steps of a pixel
    Vector3 view_;
};

}  // namespace

const PluginInfo plugin = describe<OrthographicCamera>("parallel rays, no perspective");

}  // namespace lucerna
