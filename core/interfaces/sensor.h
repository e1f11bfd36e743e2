// SPDX-License-Identifier: Apache-2.0
/// The camera: from a position on the film to a ray.
#pragma once

#include "core/interfaces/film.h"
#include "core/interfaces/interaction.h"
#include "core/interfaces/sampler.h"
#include "core/math/transform.h"
#include "core/plugin/plugin.h"

#include <optional>

namespace lucerna {

/// Where a point of the scene is seen, for particles that are traced from the lights.
struct SensorConnection {
    Vector2 position{0};   ///< on the film, as for `sample_ray`; may lie outside of it
    Vector3 p{0};          ///< where the ray that sees it starts (world)
    Vector3 wi{0};         ///< unit vector from the seen point to there (world)
    float distance = 0;    ///< between the two
    float importance = 0;  ///< image of a unit of area at the point, facing `wi` [pixels²/m²]
};

class Medium;

/// Camera space: looks along +z, y up, x to the left (Mitsuba's convention).
class Sensor : public Object {
public:
    static constexpr const char* kind = "sensor";
    /// Reads what all sensors have: `to_world`, nested film, sampler and medium.
    explicit Sensor(const Params& params);
    ~Sensor() override;

    /// The ray through `position` in pixels of the whole image, x to the right, y down; `u_lens`
    /// in [0, 1)² chooses the point on the lens.
    virtual Ray sample_ray(Vector2 position, Vector2 u_lens) const = 0;

    /// The inverse: where `p` (world) is seen through the point of the lens that `u_lens` chooses.
    /// A surface of radiance L and normal n that is seen there in dA lights |n · wi| importance dA
    /// of the film with L. Occlusion is not looked at. Empty: p is behind the camera or beyond its
    /// clip planes; unless overridden, always, and then nothing can be connected to the sensor.
    virtual std::optional<SensorConnection> connect(Vector3 p, Vector2 u_lens) const;

    /// Distance from the lens to the origin of `ray`, one of `sample_ray`: more than zero if rays
    /// start at a near clip plane.
    virtual float distance_from_lens(const Ray& ray) const;

    const Film& film() const { return *film_; }
    const Sampler& sampler() const { return *sampler_; }
    /// In which it lies; null is empty space.
    const Medium* medium() const { return medium_; }

protected:
    const Transform& world_from_camera() const { return world_from_camera_; }

private:
    Transform world_from_camera_;
    const Film* film_;
    const Sampler* sampler_;
    const Medium* medium_;
};

}  // namespace lucerna
