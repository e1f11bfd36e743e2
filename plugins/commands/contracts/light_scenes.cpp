// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/light_scenes.h"

#include "core/math/sequences.h"
#include "core/math/warp.h"

#include <fmt/format.h>

#include <random>

namespace lucerna::contracts {

namespace {

std::string text(Vector3d v) { return fmt::format("{:.17g}, {:.17g}, {:.17g}", v.x, v.y, v.z); }
std::string scale(double by) { return fmt::format("<scale value='{:.17g}'/>", by); }
std::string translate(Vector3d by) { return "<translate value='" + text(by) + "'/>"; }
std::string look(Vector3d from, Vector3d at) {
    const bool vertical =
        glm::length(glm::cross(at - from, Vector3d(0, 0, 1))) < 1e-3 * glm::length(at - from);
    return fmt::format("<lookat origin='{}' target='{}' up='{}'/>", text(from), text(at),
                       vertical ? "0, 1, 0" : "0, 0, 1");
}
std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}
std::string shape(const std::string& type, const std::string& steps, const std::string& inside) {
    return "<shape type='" + type + "'>" + to_world(steps) + inside + "</shape>";
}
std::string sphere(Vector3d center, double radius, const std::string& inside) {
    return shape("sphere", scale(radius) + translate(center), inside);
}
std::string diffuse(double reflectance) {
    return fmt::format("<bsdf type='diffuse'><rgb name='reflectance' value='{}'/></bsdf>",
                       reflectance);
}
std::string emitter(const std::string& type, const std::string& quantity, double value,
                    const std::string& inside = "") {
    return fmt::format("<emitter type='{}'><rgb name='{}' value='{:.17g}'/>{}</emitter>", type,
                       quantity, value, inside);
}
std::string area_light(double radiance) { return emitter("area", "radiance", radiance); }
std::string point_light(Vector3d p, double intensity) {
    return emitter("point", "intensity", intensity, to_world(translate(p)));
}
std::string camera(Vector3d from, Vector3d at, double fov, int width) {
    return fmt::format(
        "<sensor type='perspective'>{}<float name='fov' value='{}'/>"
        "<float name='near_clip' value='{:.17g}'/>"
        "<float name='far_clip' value='{:.17g}'/><sampler type='sobol'/>"
        "<film type='hdrfilm'><integer name='width' value='{}'/>"
        "<integer name='height' value='{}'/><rfilter type='box'/></film></sensor>",
        to_world(look(from, at)), fov, 1e-4 * glm::length(from), 1e5 * glm::length(from), width,
        width);
}

}  // namespace

std::string many_lights(double size) {
    const auto at = [&](double x, double y, double z) { return size * Vector3d(x, y, z); };
    std::string content =
        camera(at(4, -6, 5), at(0, 0, 0), 60, 8) +
        shape("rectangle", scale(10 * size), diffuse(0.5)) +
        shape("rectangle", scale(0.5 * size) + translate(at(-2, 1, 0.01)), area_light(3)) +
        shape("rectangle", scale(size) + look(at(1, 1, 3), at(0, 0, 0)), area_light(2)) +
        shape("disk", scale(0.3 * size) + look(at(-3, 1, 2), at(-4, 1, 2)), area_light(9)) +
        sphere(at(2, -2, 1), 0.4 * size, area_light(5)) +
        shape("cube", scale(0.2 * size) + translate(at(0, 3, 1)), area_light(0.1)) +
        sphere(at(0, 0, 1), 1e-4 * size, area_light(1e3)) + emitter("constant", "radiance", 0.1) +
        emitter("directional", "irradiance", 1, "<vector name='direction' value='1, 0, -1'/>");
    for (int i = 0; i < 20; ++i) {
        const double x = std::cos(2.4 * i), y = std::sin(2.4 * i);
        content += point_light(at(0.2 * i * x, 0.2 * i * y, 0.1 + 0.1 * i),
                               size * size * std::pow(10, 0.25 * (i % 9) - 1));
        content += emitter("spot", "intensity", size * size * (1 + i),
                           fmt::format("<float name='cutoff_angle' value='{}'/>", 5 + 8 * i) +
                               to_world(look(at(3 * y, 3 * x, 2), at(x, 0.1 * i, 0))));
    }
    return content;
}

std::vector<Receiver> scattered_points(int count, float size) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> number(-1, 1);
    std::vector<Receiver> result;
    for (int i = 0; i < count; ++i) {
        const float x = number(engine), y = number(engine), z = number(engine);
        const float a = number(engine), b = number(engine), c = number(engine);
        Receiver at{.p = size * Vector3(4 * x, 4 * y, 2 + 2 * z),
                    .n = glm::normalize(Vector3(a, b, c)),
                    .error = 1e-6f * size};
        at.ns = at.n;
        at.sides = i % 3 == 0 ? Sides::both : Sides::front;
        result.push_back(at);
    }
    for (const Vector3 p : {Vector3(2, -2, 1), Vector3(0, 0, 1), Vector3(1, 1, 3), Vector3(0),
                            Vector3(-2, 1, 0.01f), Vector3(0, 0, 0.1f)}) {
        result.push_back({.p = size * p, .sides = Sides::both});
    }
    return result;
}

std::string courtyard(const std::string& integrator, int width) {
    std::string content = integrator + shape("rectangle", scale(10), diffuse(0.5)) +
                          camera({7, -8, 6}, {0, 0, 0.5}, 50, width) +
                          emitter("constant", "radiance", 0.02);
    for (int i = 0; i < 25; ++i) {
        const double x = 2.0 * (i % 5) - 4, y = 2.0 * (i / 5) - 4;
        content += shape("cube", scale(0.4) + translate({x, y, 0.4}), diffuse(0.7));
        content += shape("rectangle", scale(0.1) + look({x + 0.405, y, 0.5}, {x + 1, y, 0.5}),
                         area_light(3));
        content += point_light({x + 1, y + 0.7, 0.3}, 0.2 + 0.05 * i);
        content += sphere({x - 0.9, y + 0.2, 0.2}, 0.05, area_light(20));
    }
    return content;
}

std::vector<Receiver> seen_points(const Scene& scene, int count, std::uint64_t seed) {
    std::vector<Receiver> points;
    Rng rng(seed);
    const Vector2 film(scene.sensor().film().size());
    for (int tries = 0; static_cast<int>(points.size()) < count && tries < 100 * count; ++tries) {
        const Vector2 position = film * rng.next_float2();
        const Ray ray = scene.sensor().sample_ray(position, rng.next_float2());
        const auto at = scene.intersect(ray);
        const Vector3 scattered = square_to_cosine_hemisphere(rng.next_float2());
        if (!at) continue;
        const Receiver seen = at->receiver(-ray.d, Sides::front);
        points.push_back(seen);
        const Vector3 d = Frame::from_normal(seen.n).to_world(scattered);
        if (const auto next = scene.intersect(at->spawn_ray(d))) {
            points.push_back(next->receiver(-d, Sides::front));
        }
    }
    return points;
}

}  // namespace lucerna::contracts
