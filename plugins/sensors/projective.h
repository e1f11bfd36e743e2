// SPDX-License-Identifier: Apache-2.0
/// What the projective sensors share: clip planes, and the field of view.
#pragma once

#include "core/interfaces/sensor.h"
#include "core/math/orientation.h"
#include "core/plugin/field_of_view.h"

#include <fmt/format.h>

namespace lucerna {

class ProjectiveSensor : public Sensor {
public:
    float distance_from_lens(const Ray& ray) const final {
        return near_clip_ / glm::dot(view_, ray.d);
    }

protected:
    explicit ProjectiveSensor(const Params& params)
        : Sensor(params),
          near_clip_(params.real("near_clip", 1e-2, positive,
                                 "depth below which nothing is seen [scene units]")),
          far_clip_(params.real("far_clip", 1e4, positive,
                                "depth beyond which nothing is seen [scene units]")),
          view_(glm::normalize(world_from_camera().direction(Vector3d(0, 0, 1)))) {
        if (!(near_clip_ < far_clip_)) {
            params.error("near_clip", fmt::format("near_clip is {:g}, but must be less than "
                                                  "far_clip, which is {:g}",
                                                  near_clip_, far_clip_));
        }
    }

    /// The part of the line from `o` along the unit vector `d` between the clip planes, where each
    /// unit of length gains the depth `cosine`.
    Ray clipped(Vector3 o, Vector3 d, float cosine) const {
        const float start = near_clip_ / cosine;
        return {.o = o + start * d, .d = d, .tmax = far_clip_ / cosine - start};
    }

    bool in_depth_range(float depth) const { return depth >= near_clip_ && depth <= far_clip_; }
    float near_clip() const { return near_clip_; }
    float far_clip() const { return far_clip_; }

private:
    float near_clip_, far_clip_;
    Vector3 view_;  ///< the direction in which depth grows
};

/// A camera that sees all lines through its centre: what `perspective` and `thinlens` share.
class PerspectiveSensor : public ProjectiveSensor {
protected:
    explicit PerspectiveSensor(const Params& params) : ProjectiveSensor(params) {
        const Vector2d size(film().size());
        const double half_width = half_width_at_unit_depth(params, size.x / size.y);
        const Vector2d principal(
            static_cast<double>(params.real("principal_point_offset_x", 0, any_value,
                                            "shift of the optical axis [widths of the film]")),
            static_cast<double>(params.real("principal_point_offset_y", 0, any_value,
                                            "shift of the optical axis [heights of the film]")));
        const double pixel = 2 * half_width / size.x;
        pixel_ = static_cast<float>(pixel);
        // x to the left and y up: the upper left corner has the largest coordinates.
        corner_ = Vector2(pixel * (0.5 - principal) * size);

        const std::optional<Frame> axes = orientation(world_from_camera());
        if (!axes) {
            params.error("to_world", "\"to_world\" of a perspective sensor must not stretch space");
        }
        axes_ = axes.value_or(Frame());
        origin_ = Vector3(world_from_camera().point(Vector3d(0)));
    }

    /// Where the film position [pixels] lies at the depth 1, in camera space.
    Vector2 at_unit_depth(Vector2 position) const { return corner_ - pixel_ * position; }

    Vector3 to_world(Vector3 direction) const { return axes_.to_world(direction); }
    Vector3 origin() const { return origin_; }

    /// Where `p` (world) is seen through the point `lens` of the plane z = 0 of camera space. All
    /// lines through a film position meet at the depth `focus`; it may be infinite. The film at
    /// the depth 1 covers dω / cos³ of the directions, and dω is dA / d² (pbrt 3e, 16.1.1).
    std::optional<SensorConnection> connect_through(Vector2 lens, float focus, Vector3 p) const {
        const Vector3 q = axes_.to_local(p - origin_);
        if (!in_depth_range(q.z)) return {};
        const Vector3 to_point = q - Vector3(lens, 0);
        const float distance = glm::length(to_point);
        const Vector2 at_depth_1 = Vector2(to_point) / to_point.z + lens / focus;
        const float cosine = to_point.z / distance;
        return SensorConnection{
            .position = (corner_ - at_depth_1) / pixel_,
            .p = origin_ + to_world(Vector3(lens, 0) + to_point * (near_clip() / to_point.z)),
            .wi = to_world(-to_point / distance),
            .distance = distance - near_clip() / cosine,
            .importance = 1 / (sqr(pixel_ * distance) * cosine * cosine * cosine)};
    }

private:
    float pixel_ = 0;    ///< side of a pixel at the depth 1
    Vector2 corner_{0};  ///< upper left corner of the film at the depth 1
    Frame axes_;
    Vector3 origin_{0};
};

}  // namespace lucerna
