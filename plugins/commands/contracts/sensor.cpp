// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/sensor.h"

#include "core/math/frame.h"

#include <fmt/format.h>

namespace lucerna::contracts {

namespace {

/// A position on the film or close to it.
Vector2 position_on(const Film& film, Rng& rng) {
    const Vector2 size(film.size());
    return size * (1.2f * rng.next_float2() - 0.1f);
}

std::string text(Vector2 v) { return fmt::format("({:.6g}, {:.6g})", v.x, v.y); }

}  // namespace

Evidence sensor_rays(const Sensor& sensor, const Effort& effort) {
    Evidence evidence("rays are unit and finite");
    Rng rng(hash64({effort.seed, 1}));
    for (int i = 0; i < effort.part(20); ++i) {
        const Vector2 position = position_on(sensor.film(), rng);
        const Vector2 u = i == 0 ? Vector2(0) : rng.next_float2();
        const Ray ray = sensor.sample_ray(position, u);
        const auto must = [&](bool holds, const char* what) {
            evidence.require(holds, [&] {
                return fmt::format("{} at {}, lens {}", what, text(position), text(u));
            });
        };
        must(std::abs(glm::length(ray.d) - 1) < 1e-6f, "the direction is no unit vector");
        must(is_finite(ray.o), "the origin is not finite");
        must(ray.tmax > 0, "the ray has no length");
        must(sensor.distance_from_lens(ray) >= 0, "the lens is in front of the ray");
    }
    return evidence;
}

Evidence sensor_connections(const Sensor& sensor, const Effort& effort) {
    Evidence evidence("connect is the inverse of sample_ray");
    Rng rng(hash64({effort.seed, 2}));
    const float film = static_cast<float>(std::max(sensor.film().size().x, 1));
    for (int i = 0; i < effort.part(200); ++i) {
        const Vector2 position = position_on(sensor.film(), rng);
        const Vector2 u_lens = rng.next_float2();
        const Ray ray = sensor.sample_ray(position, u_lens);
        const float t = std::min(1 + 5 * rng.next_float(), 0.9f * ray.tmax);
        const Vector3 p = ray.o + t * ray.d;
        const auto seen = sensor.connect(p, u_lens);
        // Sensors that nothing can be connected to are not tried.
        if (!seen && i == 0) return evidence;
        const auto must = [&](bool holds, const char* what) {
            evidence.require(holds, [&] {
                return fmt::format("{} at {}, lens {}, {:.4g} m away", what, text(position),
                                   text(u_lens), t);
            });
        };
        must(seen.has_value(), "a point is not seen that lies on a ray");
        if (!seen) continue;
        const float size = 1 + max_component(absolute(ray.o));
        must(glm::length(seen->position - position) < 2e-5f * film, "another position is seen");
        must(glm::length(seen->p - ray.o) < 1e-5f * size, "another origin is found");
        must(glm::length(seen->wi + ray.d) < 1e-5f * size, "another direction is found");
        must(std::abs(seen->distance - t) < 1e-4f * size, "another distance is found");
        must(!sensor.connect(ray.o - 0.1f * ray.d, u_lens), "a point behind the lens is seen");
    }
    return evidence;
}

Evidence sensor_importance(const Sensor& sensor, const Effort& effort) {
    Evidence evidence("importance is the scale of the image");
    Rng rng(hash64({effort.seed, 3}));
    for (int i = 0; i < effort.part(1000); ++i) {
        const Vector2 u_lens = rng.next_float2();
        const Vector2 position = Vector2(sensor.film().size()) * rng.next_float2();
        const Ray ray = sensor.sample_ray(position, u_lens);
        const Vector3 p = ray.o + std::min(4.0f, 0.5f * ray.tmax) * ray.d;
        const auto middle = sensor.connect(p, u_lens);
        if (!middle) continue;
        const Frame facing = Frame::from_normal(ray.d);
        const float h = 5e-3f * middle->distance;
        const auto moved = [&](Vector3 by) {
            const auto seen = sensor.connect(p + by, u_lens);
            return seen ? seen->position : Vector2(infinity);
        };
        const Vector2 a = (moved(h * facing.s) - moved(-h * facing.s)) / (2 * h);
        const Vector2 b = (moved(h * facing.t) - moved(-h * facing.t)) / (2 * h);
        const float scale = std::abs(a.x * b.y - a.y * b.x);
        evidence.require(std::abs(scale - middle->importance) <= 3e-3f * scale, [&] {
            return fmt::format("{} at {}, and the image grows by {} pixels²/m²", middle->importance,
                               text(position), scale);
        });
    }
    return evidence;
}

std::vector<Evidence> check(const Sensor& sensor, const Effort& effort) {
    return {sensor_rays(sensor, effort), sensor_connections(sensor, effort),
            sensor_importance(sensor, effort)};
}

}  // namespace lucerna::contracts
