// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/shape.h"

#include "core/math/rounding.h"
#include "core/math/warp.h"

#include <fmt/format.h>

#include <array>

namespace lucerna::contracts {

namespace {

std::string text(Vector3 v) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", v.x, v.y, v.z); }

constexpr std::size_t octants = 8;

/// One of eight parts of all directions, whose borders follow no axis.
std::size_t octant(Vector3 d) {
    return static_cast<std::size_t>((d.x + 0.1f * d.y > 0) + 2 * (d.y > 0.2f * d.z) +
                                    4 * (d.z > -0.3f * d.x));
}

void add_to_octants(std::array<RunningStatistics, octants>& sums, Vector3 d, double value) {
    for (std::size_t k = 0; k < octants; ++k) sums[k].add(k == octant(d) ? value : 0.0);
}

}  // namespace

float ShapeTrial::magnitude() const {
    const Bounds3 b = shape.bounds();
    return max_component(glm::max(absolute(b.min), absolute(b.max)));
}

std::optional<Interaction> ShapeTrial::meet(Vector3 p, Vector3 d) const {
    return scene.intersect({.o = p, .d = glm::normalize(d)});
}

SurfaceSample ShapeTrial::sample(Rng& rng) const {
    const std::uint32_t primitive = rng.next_uint() % shape.primitive_count();
    return shape.sample_area(primitive, rng.next_float2());
}

std::vector<Vector3> ShapeTrial::viewpoints() const {
    const Bounds3 b = shape.bounds();
    const float size = max_component(b.extent());
    return {b.center() + size * Vector3(20, 31, -17), b.center() + size * Vector3(0.9f, 0.8f, 0.7f),
            b.center() + size * Vector3(0.02f, 0.13f, 0.61f),
            b.center() + 0.1f * size * Vector3(0.31f, -0.17f, 0.23f)};
}

namespace {

/// What a ray from just above a sampled point must meet.
void require_met(const ShapeTrial& trial, std::uint32_t primitive, const SurfaceSample& s,
                 Evidence& evidence) {
    const float height = 1e-3f * trial.extent(), tolerance = 1e-5f * trial.magnitude();
    const auto hit = trial.meet(s.p + height * s.n, -s.n);
    const auto must = [&](bool holds, const char* what) {
        evidence.require(holds, [&] { return what + std::string(" at ") + text(s.p); });
    };
    must(hit.has_value(), "a ray misses a sampled point");
    if (!hit || hit->t < height - 2 * tolerance) return;  // another part is in between
    must(glm::length(hit->p - s.p) < tolerance, "a ray to a sampled point meets another one");
    must(glm::dot(hit->n, s.n) > 0.9999f, "hit and sample have different normals");
    must(glm::dot(hit->n, hit->shading.n) > 0, "the shading normal is on the other side");
    const Frame& frame = hit->shading;
    const float determinant = glm::dot(glm::cross(frame.s, frame.t), frame.n);
    must(std::abs(determinant - 1) < 1e-5f, "no frame of three perpendicular unit vectors");
    const Vector2 uv = trial.shape.uv_of(primitive, s);
    const Vector2 off = absolute(hit->uv - uv);  // u may jump at the seam
    must((off.x < 1e-3f || off.x > 0.999f) && (off.y < 1e-3f || off.y > 0.999f),
         "hit and sample have different uv");
}

}  // namespace

Evidence shape_samples(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("points sampled by area lie on the surface");
    constexpr float corners[] = {0, 0.5f, one_minus_epsilon};
    const Shape& shape = trial.shape;
    Rng rng(hash64({effort.seed, 3}));
    for (int i = 0; i < effort.part(200); ++i) {
        const auto primitive = rng.next_uint() % shape.primitive_count();
        Vector2 u = rng.next_float2();
        if (i < 9) u = Vector2(corners[i % 3], corners[i / 3]);
        const SurfaceSample s = shape.sample_area(primitive, u);
        const auto must = [&](bool holds, const char* what) {
            return evidence.require(holds, [&] {
                return fmt::format("{} of primitive {} at {}", what, primitive, text(s.p));
            });
        };
        if (!must(is_finite(s.p) && is_finite(s.n), "not finite: a sample")) continue;
        must(std::abs(glm::length(s.n) - 1) < 1e-5f, "no unit vector: the normal");
        const float density = 1 / shape.area(primitive);
        must(std::abs(s.pdf - density) <= 4e-7f * density, "not 1 / area: the pdf");
        must(s.error > 0 && s.error < 1e-5f * trial.magnitude(), "too large or zero: the error");
        const Bounds3 box = shape.primitive_bounds(primitive);
        const Vector3 margin(2 * s.error);
        must(Bounds3{box.min - margin, box.max + margin}.contains(s.p), "outside of the bounds");
        const auto [axis, cosine] = shape.normal_cone(primitive);
        must(glm::dot(axis, s.n) >= cosine - 1e-5f, "outside of the normal cone: the normal");
        if (i >= 9) require_met(trial, primitive, s, evidence);  // a ray to an edge may miss
    }
    return evidence;
}

Evidence shape_areas(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("areas are those that random lines measure");
    const Shape& shape = trial.shape;
    const float radius = 1.01f * shape.bounds().radius();
    const Vector3 center = shape.bounds().center();
    const std::uint32_t count = shape.primitive_count();
    const bool each = count > 1 && count <= 64;
    RunningStatistics all;
    std::vector<RunningStatistics> parts(each ? count : 0);
    std::vector<double> crossings(parts.size());
    Rng rng(hash64({effort.seed, 4}));
    const double per_crossing = 2 * std::numbers::pi * sqr(static_cast<double>(radius));
    for (int i = 0; i < effort.samples; ++i) {
        const Frame frame = Frame::from_normal(square_to_uniform_sphere(rng.next_float2()));
        const Vector2 offset = radius * square_to_uniform_disk(rng.next_float2());
        Ray ray{.o = center + frame.to_world({offset.x, offset.y, -1.1f * radius}), .d = frame.n};
        std::fill(crossings.begin(), crossings.end(), 0.0);
        int number = 0;
        for (auto hit = trial.scene.intersect(ray); hit && number < 10000; ++number) {
            if (each) ++crossings[hit->primitive];
            hit = trial.scene.intersect(hit->spawn_ray(ray.d));
        }
        all.add(number * per_crossing);
        for (std::size_t k = 0; k < parts.size(); ++k) parts[k].add(crossings[k] * per_crossing);
    }
    double told = 0;
    for (std::uint32_t k = 0; k < count; ++k) told += static_cast<double>(shape.area(k));
    // Lines that pass an edge by less than a rounding error may be missed or met twice.
    constexpr double rounding = 1e-4;
    evidence.test(mean_is(all, told, rounding * told), "m² in all");
    for (std::uint32_t k = 0; k < parts.size(); ++k) {
        const double area = static_cast<double>(shape.area(k));
        evidence.test(mean_is(parts[k], area, rounding * area), fmt::format("m² of part {}", k));
    }
    return evidence;
}

Evidence shape_solid_angles(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("solid angles are those that rays see");
    const Shape& shape = trial.shape;
    const auto count = shape.primitive_count();
    const Bounds3 box = shape.bounds();
    const int samples = effort.part(5, 5000);
    for (const Vector3 p : trial.viewpoints()) {
        Rng rng(hash64({effort.seed, 11}));
        std::array<RunningStatistics, octants> own, blind;
        const Receiver from{.p = p};
        for (int i = 0; i < samples; ++i) {
            const auto primitive = static_cast<std::uint32_t>(i) % count;
            const auto s = shape.sample_solid_angle(primitive, from, rng.next_float2());
            const Vector3 d = s ? s->p - p : Vector3(1);
            const auto hit = s ? trial.meet(p, d) : std::nullopt;
            const bool visible =
                hit && hit->primitive == primitive &&
                glm::length(hit->p - s->p) < 1e-4f * trial.extent() + 1e-6f * trial.magnitude();
            add_to_octants(own, d, visible ? count / static_cast<double>(s->pdf) : 0.0);
            if (!visible) continue;
            const float pdf = shape.pdf_solid_angle(primitive, from, glm::normalize(d), *hit);
            // At grazing angles a rounded direction meets a round surface elsewhere.
            const float cosine = std::abs(glm::dot(glm::normalize(d), hit->n));
            const float tolerance = 1e-4f + 1e-4f / (cosine * cosine);
            evidence.require(std::abs(pdf / s->pdf - 1) <= tolerance, [&] {
                return fmt::format("pdf is {} from the sample, {} from pdf_solid_angle at {}",
                                   s->pdf, pdf, text(s->p));
            });
        }
        // A cone around the box, or the sphere.
        const auto cone = SphereCone::from(p, box.center(), 1.01f * box.radius());
        const double domain = cone ? cone->solid_angle() : 4 * std::numbers::pi;
        std::array<int, octants> met{};
        for (int i = 0; i < samples; ++i) {
            const Vector2 u = rng.next_float2();
            const Vector3 d =
                cone ? cone->sample(Vector2d(u)).direction : square_to_uniform_sphere(u);
            const bool hit = trial.meet(p, d).has_value();
            met[octant(d)] += hit;
            add_to_octants(blind, d, hit ? domain : 0.0);
        }
        for (std::size_t k = 0; k < octants; ++k) {
            // What few rays meet is too far from normal to be judged.
            constexpr int few = 50;
            if (met[k] < few && own[k].mean() * samples < few * domain) continue;
            evidence.test(means_agree(own[k], blind[k], 1e-4 * blind[k].mean()),
                          fmt::format("sr sampled and seen from {}, octant {}", text(p), k));
        }
    }
    return evidence;
}

namespace {

/// Nearest t of the ray by looking at each triangle (Möller and Trumbore 1997), in double;
/// infinite if it hits none.
double nearest_triangle(const TriangleGeometry& mesh, const Ray& ray) {
    const Vector3d o(ray.o), d(ray.d);
    double nearest = static_cast<double>(infinity);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Vector3d a(mesh.positions[mesh.indices[i]]);
        const Vector3d e1 = Vector3d(mesh.positions[mesh.indices[i + 1]]) - a;
        const Vector3d e2 = Vector3d(mesh.positions[mesh.indices[i + 2]]) - a;
        const Vector3d h = glm::cross(d, e2), s = o - a, q = glm::cross(s, e1);
        const double determinant = glm::dot(e1, h);
        if (determinant == 0) continue;
        const double u = glm::dot(s, h) / determinant, v = glm::dot(d, q) / determinant;
        const double t = glm::dot(e2, q) / determinant;
        if (u >= 0 && v >= 0 && u + v <= 1 && t >= 0) nearest = std::min(nearest, t);
    }
    return nearest;
}

}  // namespace

Evidence shape_hits(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("the nearest hit is found");
    const Geometry geometry = trial.shape.geometry();
    const auto* const mesh = std::get_if<TriangleGeometry>(&geometry);
    const bool few = mesh && mesh->indices.size() <= 3000;
    Rng rng(hash64({effort.seed, 5}));
    int beside_edges = 0;
    const int rays = effort.part(40);
    for (int i = 0; i < rays; ++i) {
        const SurfaceSample target = trial.sample(rng);
        const float distance = trial.extent() * (0.1f + 3 * rng.next_float());
        const Vector3 from = target.p + distance * square_to_uniform_sphere(rng.next_float2());
        const Ray ray{.o = from, .d = glm::normalize(target.p - from)};
        const auto hit = trial.scene.intersect(ray);
        const float tolerance = 1e-5f * (trial.magnitude() + distance);
        const float cosine = std::abs(glm::dot(ray.d, target.n));
        if (cosine < 0.02f) continue;
        // A point near an edge may be missed by a rounding error.
        if (!hit || hit->t > distance + tolerance / cosine) {
            ++beside_edges;
            continue;
        }
        if (few) {
            const auto exact = static_cast<float>(nearest_triangle(*mesh, ray));
            const float slope = std::abs(glm::dot(ray.d, hit->n));
            const bool same = std::abs(exact - hit->t) <= tolerance / std::max(slope, 1e-3f);
            if (!same) ++beside_edges;
        }
        // Nothing lies between the origin and the hit.
        const Ray back = hit->spawn_ray(-ray.d);
        const auto before = trial.scene.intersect(back);
        if (std::abs(glm::dot(ray.d, hit->n)) < 0.02f) continue;
        evidence.require(!before || before->t > hit->t - tolerance, [&] {
            return fmt::format("from {} along {} the hit is at {}, and there is one at {}",
                               text(ray.o), text(ray.d), hit->t, hit->t - before->t);
        });
    }
    evidence.require(beside_edges <= rays / 500, [&] {
        return fmt::format("{} of {} rays miss what they aim at", beside_edges, rays);
    });
    return evidence;
}

Evidence shape_errors(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("points are on the surface within their error");
    Rng rng(hash64({effort.seed, 5}));
    int lost = 0, hits = 0;
    const int rays = effort.part(50, 1000);
    for (int i = 0; i < rays; ++i) {
        const Vector3 target = trial.sample(rng).p;
        const float distance = trial.extent() * std::exp2(24 * rng.next_float() - 4);
        const Vector3 from = target + distance * square_to_uniform_sphere(rng.next_float2());
        const auto hit = trial.meet(from, target - from);
        if (!hit) continue;
        ++hits;
        // What leaves either side of the surface does not meet it again at once.
        for (const float side : {1.0f, -1.0f}) {
            const auto next = trial.scene.intersect(hit->spawn_ray(side * hit->n));
            evidence.require(!next || next->t >= 16 * hit->error, [&] {
                return "a ray that leaves meets the surface again at " + text(hit->p);
            });
        }
        // The surface is between the two ends of the error bound.
        const float back = glm::dot(hit->n, from - hit->p) > 0 ? -1.0f : 1.0f;
        const Vector3 start = offset_ray_origin(hit->p, hit->error, hit->n, -back * hit->n);
        const auto through = trial.scene.intersect({.o = start, .d = back * hit->n});
        if (!through || through->t > 8 * hit->error) ++lost;
    }
    evidence.require(hits > rays / 2,
                     [&] { return fmt::format("only {} of {} rays hit", hits, rays); });
    evidence.require(lost <= hits / 200, [&] {  // beside an edge
        return fmt::format("the surface is beyond the error bound at {} of {} points", lost, hits);
    });
    return evidence;
}

Evidence shape_derivatives(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("derivatives follow the parameters");
    Rng rng(hash64({effort.seed, 9}));
    const float height = 0.01f * trial.extent();
    for (int i = 0; i < effort.part(2000); ++i) {
        const SurfaceSample s = trial.sample(rng);
        const auto a = trial.meet(s.p + height * s.n, -s.n);
        if (!a) continue;
        const auto must = [&](bool holds, const char* what) {
            evidence.require(holds, [&] { return what + std::string(" at ") + text(s.p); });
        };
        must(std::abs(glm::dot(a->n, glm::normalize(a->dpdu))) < 1e-4f,
             "dpdu is not perpendicular to the normal");
        must(std::abs(glm::dot(a->shading.s, a->shading.n)) < 1e-5f,
             "the shading frame is not orthogonal");
        // A neighbour lies where the linear map says.
        const Vector3 step =
            2e-3f * trial.extent() * Frame::from_normal(s.n).to_world({0.8f, 0.6f, 0});
        const auto b = trial.meet(s.p + height * s.n + step, -s.n);
        if (!b || b->primitive != a->primitive) continue;
        const Vector2 duv = b->uv - a->uv;
        if (std::abs(duv.x) > 0.1f || std::abs(duv.y) > 0.1f) continue;  // a seam or pole
        const Vector3 expected = duv.x * a->dpdu + duv.y * a->dpdv;
        must(glm::length(expected - (b->p - a->p)) < 0.1f * glm::length(step),
             "dpdu and dpdv do not lead to a neighbour");
    }
    return evidence;
}

Evidence shape_lanes(const ShapeTrial& trial, const Effort& effort) {
    Evidence evidence("many points at once are each by itself");
    Rng rng(hash64({effort.seed, 4}));
    for (std::size_t count = 1; count <= lane_count; ++count) {
        const auto primitive = rng.next_uint() % trial.shape.primitive_count();
        Vector2Lanes u{};
        for (std::size_t i = 0; i < count; ++i) u.set(i, rng.next_float2());
        SurfaceSampleLanes lanes;
        trial.shape.batch().sample_area(trial.shape, primitive, u, count, lanes);
        for (std::size_t i = 0; i < count; ++i) {
            const SurfaceSample one = trial.shape.sample_area(primitive, u[i]);
            const bool same = lanes.p[i] == one.p && lanes.n[i] == one.n &&
                              lanes.hit_uv[i] == one.hit_uv && lanes.error[i] == one.error &&
                              lanes.pdf[i] == one.pdf;
            evidence.require(same, [&] { return fmt::format("lane {} of {} differs", i, count); });
        }
    }
    return evidence;
}

std::vector<Evidence> check(const ShapeTrial& trial, const Effort& effort) {
    return {shape_samples(trial, effort),      shape_areas(trial, effort),
            shape_solid_angles(trial, effort), shape_hits(trial, effort),
            shape_errors(trial, effort),       shape_derivatives(trial, effort),
            shape_lanes(trial, effort)};
}

}  // namespace lucerna::contracts
