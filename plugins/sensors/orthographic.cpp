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

private:
    Vector3 corner_, per_column_, per_row_;  ///< upper left corner of the film, steps of a pixel
    Vector3 view_;
};

}  // namespace

const PluginInfo plugin = describe<OrthographicCamera>("parallel rays, no perspective");

}  // namespace lucerna
