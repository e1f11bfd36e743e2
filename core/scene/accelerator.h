// SPDX-License-Identifier: Apache-2.0
/// Rays against all shapes. The only user of Embree.
#pragma once

#include "core/interfaces/shape.h"
#include "core/scene/ray_queries.h"

#include <memory>
#include <optional>
#include <span>

namespace lucerna {

/// What a ray met: a shape of the world, or a shape of a group through an instance.
struct SceneHit {
    Hit hit;
    const Shape* shape = nullptr;
    const Shape* instance = nullptr;  ///< null if the shape is in the world itself
    PrimitiveId id{};
    bool flat = false;   ///< a triangle or parallelogram: cannot be hit from its own surface
    bool large = false;  ///< the shape has more primitives than the nearest cache holds
};

class Accelerator {
public:
    /// Builds over shapes, which must outlive it; `threads` = 0 uses all. Throws Error.
    Accelerator(std::span<Shape* const> shapes, int threads);
    ~Accelerator();

    /// The nearest hit with tmin <= t <= ray.tmax; false, and `met` is left alone, if there is
    /// none. The ray must be finite.
    bool intersect(const Ray& ray, float tmin, SceneHit& met) const;
    /// True if something lies on the ray that is neither `ray.source` nor `target`. The ray must
    /// be finite; its direction may have any length but zero.
    bool occluded(const Ray& ray, PrimitiveId target) const;
    /// The same for those of sixteen that are open.
    void occluded(ShadowPacket& rays) const;

    /// Memory [bytes].
    std::size_t bytes() const;

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace lucerna
