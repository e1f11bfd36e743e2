// SPDX-License-Identifier: Apache-2.0
/// thinlens: a camera with an ideal lens, sharp at one depth.
///
/// All rays through a film position meet at the depth focus_distance; they start on a disk of
/// aperture_radius. A point at the depth z is blurred to the diameter 2 r |z − f| / f, measured at
/// its own depth (pbrt 4e, 5.2.3). A radius of zero gives the image of `perspective`.
#include "plugins/sensors/projective.h"

#include "core/math/warp.h"

namespace lucerna {

namespace {

class ThinLensCamera final : public PerspectiveSensor {
public:
    explicit ThinLensCamera(const Params& params)
        : PerspectiveSensor(params),
          aperture_radius_(params.real("aperture_radius", 0, non_negative,
                                       "of the lens [scene units]; must be given")),
          focus_distance_(params.real("focus_distance", static_cast<double>(far_clip()), positive,
                                      "depth that is sharp [scene units]: far_clip by default")) {
        if (!params.has("aperture_radius")) {
            params.error("aperture_radius", "a thinlens needs its aperture_radius");
        }
    }

    Ray sample_ray(Vector2 position, Vector2 u_lens) const override {
        const Vector2 lens = aperture_radius_ * square_to_uniform_disk(u_lens);
        // Divided by the focus distance: it may be as large as a float can be.
        const Vector3 d =
            glm::normalize(Vector3(at_unit_depth(position) - lens / focus_distance_, 1));
        return clipped(origin() + to_world(Vector3(lens, 0)), to_world(d), d.z);
    }

    std::optional<SensorConnection> connect(Vector3 p, Vector2 u_lens) const override {
        const Vector2 lens = aperture_radius_ * square_to_uniform_disk(u_lens);
        return connect_through(lens, focus_distance_, p);
    }

private:
    float aperture_radius_, focus_distance_;
};

}  // namespace

const PluginInfo plugin = describe<ThinLensCamera>("a camera with depth of field");

}  // namespace lucerna
