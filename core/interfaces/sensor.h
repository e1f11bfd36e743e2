// SPDX-License-Identifier: Apache-2.0
/// The camera: from a position on the film to a ray.
#pragma once

#include "core/interfaces/film.h"
#include "core/interfaces/sampler.h"
#include "core/interfaces/samples.h"
#include "core/math/transform.h"
#include "core/plugin/plugin.h"

namespace lucerna {

/// Camera space: looks along +z, y up, x to the left (Mitsuba's convention).
class Sensor : public Object {
public:
    static constexpr const char* kind = "sensor";
    /// Reads what all sensors have: `to_world`, nested film and sampler.
    explicit Sensor(const Params& params);
    ~Sensor() override;

    /// The ray through `position` in pixels of the whole image, x to the right, y down; `u_lens`
    /// in [0, 1)² chooses the point on the lens.
    virtual Ray sample_ray(Vector2 position, Vector2 u_lens) const = 0;

    const Film& film() const { return *film_; }
    const Sampler& sampler() const { return *sampler_; }

protected:
    const Transform& world_from_camera() const { return world_from_camera_; }

private:
    Transform world_from_camera_;
    const Film* film_;
    const Sampler* sampler_;
};

}  // namespace lucerna
