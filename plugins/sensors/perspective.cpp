// SPDX-License-Identifier: Apache-2.0
/// perspective: a pinhole camera, sharp at all depths.
///
/// The film position (x, y), in pixels of a film of w × h, is seen along
///
///   d = (a (1 − 2 (x/w + pₓ)), a h/w (1 − 2 (y/h + p_y)), 1),   a = tan(fov / 2) for fov_axis x
///
/// in camera space, where p is the principal point offset. Pixels are square.
#include "plugins/sensors/projective.h"

namespace lucerna {

namespace {

class PerspectiveCamera final : public PerspectiveSensor {
public:
    explicit PerspectiveCamera(const Params& params) : PerspectiveSensor(params) {
        params.no_effect("focus_distance", "a pinhole is sharp everywhere; thinlens is not");
    }

    Ray sample_ray(Vector2 position, Vector2) const override {
        const Vector3 d = glm::normalize(Vector3(at_unit_depth(position), 1));
        return clipped(origin(), to_world(d), d.z);
    }

    std::optional<SensorConnection> connect(Vector3 p, Vector2) const override {
        return connect_through(Vector2(0), infinity, p);
    }
};

}  // namespace

const PluginInfo plugin = describe<PerspectiveCamera>("a pinhole camera");

}  // namespace lucerna
