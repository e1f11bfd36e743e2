// SPDX-License-Identifier: Apache-2.0
/// In which medium a ray starts that does not come from the camera.
#pragma once

#include "core/interfaces/medium.h"
#include "core/scene/medium_tracking.h"
#include "core/scene/scene.h"

namespace lucerna {

/// The first surface with media on a ray tells what was before it: what has none on its sides
/// changes nothing. If there is none, the ray ends where the scene does.
class MediumAround {
public:
    explicit MediumAround(const Scene& scene) : scene_(scene), outermost_(scene.sensor().medium()) {
        // A straight line from the camera ends there, too.
        const Vector2i size = scene.sensor().film().size();
        const Ray ray = scene.sensor().sample_ray(0.5f * Vector2(size), Vector2(0.5f));
        for (auto at = scene.intersect(ray); at; at = scene.intersect(at->spawn_ray(ray.d))) {
            outermost_ = medium_beyond(*at, ray.d, outermost_);
        }
    }

    /// Around the scene, without end; null is empty space.
    const Medium* outermost() const { return outermost_; }

    /// At the origin of a ray that meets `at` first.
    const Medium* find(const Ray& ray, std::optional<Interaction> at) const {
        for (; at; at = scene_.intersect(at->spawn_ray(ray.d))) {
            if (at->shape->media()) return at->shape->media().beyond(at->n, -ray.d);
        }
        return outermost_;
    }

private:
    const Scene& scene_;
    const Medium* outermost_;
};

}  // namespace lucerna
