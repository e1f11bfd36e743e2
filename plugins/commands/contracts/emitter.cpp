// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/emitter.h"

#include "core/math/warp.h"

#include <fmt/format.h>

#include <array>

namespace lucerna::contracts {

namespace {

std::string text(Vector3 v) { return fmt::format("({:.5g}, {:.5g}, {:.5g})", v.x, v.y, v.z); }

/// Functions that a density must weight rightly: moments of the direction.
constexpr std::size_t moment_count = 5;
std::array<double, moment_count> moments(Vector3 w) {
    const Vector3d d(w);
    return {1, 1 + d.x, 1 + d.y, 1 + d.z, sqr(d.x - d.z)};
}

/// One light of all, each with the same probability.
const Light& any_light(const Scene& scene, Rng& rng) {
    return scene.lights()[rng.next_uint() % scene.lights().size()];
}

/// Radiance that rays along `w` from `p` find by chance.
Color seen_radiance(const EmitterTrial& trial, Vector3 p, Vector3 w) {
    if (trial.emitter().infinite()) return trial.emitter().environment(w);
    const auto hit = trial.scene.intersect({.o = p, .d = w});
    if (!hit || hit->shape->emitter() != &trial.emitter()) return Color(0);
    return trial.emitter().radiance(*hit, -w);
}

}  // namespace

EmitterTrial::EmitterTrial(const Scene& lit) : scene(lit), center(0), radius(0.2f) {
    const Light& light = scene.lights()[0];
    const LightBounds bounds = light.emitter->bounds(light);
    if (light.emitter->infinite()) {
        center = scene.bounds().center();
        radius = 0.3f * scene.bounds().radius();
        return;
    }
    // In front, and not in the middle of a cone.
    const float size = std::max(0.5f * max_component(bounds.box.extent()), 1e-3f);
    const float scale = bounds.box.extent() == Vector3(0) ? 1.0f : size;
    const Frame frame = Frame::from_normal(bounds.axis);
    center = bounds.box.center() + scale * frame.to_world({0.1f, 0.2f, 0.75f});
    radius = 0.2f * scale;
}

Receiver EmitterTrial::receiver(Rng& rng) const {
    const Vector3 n = square_to_uniform_sphere(rng.next_float2());
    const Vector3 offset = square_to_uniform_sphere(rng.next_float2());
    return {
        .p = center + radius * rng.next_float() * offset, .n = n, .ns = n, .sides = Sides::both};
}

std::optional<Vector3> EmitterTrial::entry(const Ray& ray) const {
    const Vector3d o = Vector3d(ray.o) - Vector3d(center), d(ray.d);
    const double r = static_cast<double>(radius);
    const double b = glm::dot(o, d), c = glm::dot(o, o) - r * r, root = b * b - c;
    if (root < 0 || c < 0 || -b - std::sqrt(root) < 0) return {};
    return Vector3((o + (-b - std::sqrt(root)) * d) / r);
}

Evidence emitter_nature(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("is what it says");
    const Scene& scene = trial.scene;
    const Emitter& e = trial.emitter();
    const auto must = [&](bool holds, const char* what) {
        evidence.require(holds, [&] { return std::string(what); });
    };
    must(e.on_surface() == (scene.lights()[0].shape != nullptr), "on_surface() is wrong");
    must(scene.infinite_lights().size() == (e.infinite() ? 1u : 0u), "infinite() is wrong");
    double power = 0;
    for (const Light& light : scene.lights()) {
        const LightBounds b = e.bounds(light);
        must(b.box.empty() == e.infinite(), "the box of the bounds is empty, or is not");
        must(b.power >= 0 && std::isfinite(b.power), "the power of the bounds is no power");
        power += b.power;
    }
    must(power > 0, "the bounds have no power");
    Rng rng(hash64({effort.seed, 1}));
    for (int i = 0; i < effort.part(200); ++i) {
        const Receiver at = trial.receiver(rng);
        const Light& light = any_light(scene, rng);
        const auto sample = e.sample_li(light, at, rng.next_float2());
        if (!sample) continue;
        must(sample->delta == e.delta(), "a sample and delta() disagree");
        must((sample->distance == infinity) == e.infinite(), "a sample is at another distance");
        must(std::abs(glm::length(sample->wi) - 1) < 1e-5f, "wi is no unit vector");
        if (!e.delta()) continue;
        const Interaction anywhere;
        must(sample->pdf == 1, "the pdf of a delta light is not 1");
        must(e.pdf_li(light, at, sample->wi, &anywhere) == 0, "pdf_li of a delta light is not 0");
        must(is_black(e.environment(sample->wi)), "a delta light can be met by chance");
    }
    return evidence;
}

Evidence emitter_extreme_numbers(const EmitterTrial& trial) {
    Evidence evidence("extreme random numbers are harmless");
    const Light& light = trial.scene.lights()[0];
    constexpr std::array extremes = {0.0f, 0x1p-24f, 0.5f, one_minus_epsilon};
    for (const float x : extremes) {
        for (const float y : extremes) {
            const auto where = [&](const char* what) {
                return fmt::format("{} for u = {}, {}", what, x, y);
            };
            for (const Sides sides : {Sides::front, Sides::back, Sides::both}) {
                const Receiver at{
                    .p = trial.center, .n = {0, 0, -1}, .ns = {0, 0, -1}, .sides = sides};
                const auto li = light.emitter->sample_li(light, at, {x, y});
                if (!li) continue;
                evidence.require(is_finite(li->radiance) && is_finite(li->wi) && li->pdf > 0 &&
                                     std::isfinite(li->pdf),
                                 [&] { return where("arriving light is not finite"); });
            }
            const auto e = light.emitter->sample_emission(light, {x, y}, {y, x});
            if (!e) continue;
            evidence.require(is_finite(e->power) && is_finite(e->ray.o) && is_finite(e->ray.d) &&
                                 std::isfinite(e->pdf_position * e->pdf_direction),
                             [&] { return where("a particle is not finite"); });
        }
    }
    return evidence;
}

Evidence emitter_densities(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("sampled light is the evaluated one");
    const Emitter& e = trial.emitter();
    if (e.delta()) return evidence;
    Rng rng(hash64({effort.seed, 4}));
    int compared = 0, different = 0;
    for (int i = 0; i < effort.part(40); ++i) {
        const Receiver at = trial.receiver(rng);
        const auto lights = static_cast<std::uint32_t>(trial.scene.lights().size());
        const std::uint32_t index = rng.next_uint() % lights;
        const Light& light = trial.scene.lights()[index];
        const auto sample = e.sample_li(light, at, rng.next_float2());
        if (!sample) continue;
        const auto hit = trial.scene.intersect({.o = at.p, .d = sample->wi});
        float pdf = 0;
        Color radiance(0);
        if (e.infinite()) {
            if (e.primitive_along(sample->wi) != light.primitive) continue;  // at its border
            pdf = e.pdf_li(light, at, sample->wi, nullptr);
            radiance = e.environment(sample->wi);
        } else {
            if (!hit || hit->shape != light.shape) continue;  // beside an edge
            if (Scene::light_of(*hit) != index) continue;
            pdf = e.pdf_li(light, at, sample->wi, &*hit);
            radiance = e.radiance(*hit, -sample->wi);
        }
        ++compared;
        const float tolerance = 2e-3f * max_component(sample->radiance) + 1e-6f;
        different += std::abs(pdf - sample->pdf) > 2e-3f * sample->pdf ||
                     max_component(absolute(radiance - sample->radiance)) > tolerance;
    }
    if (compared == 0) return evidence;
    // A rounded direction can meet the next texel, or the other side of an edge.
    evidence.require(different <= compared / 100, [&] {
        return fmt::format("{} of {} samples have another density or radiance than is evaluated",
                           different, compared);
    });
    return evidence;
}

Evidence emitter_coverage(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("sampled light is what rays find by chance");
    const Emitter& e = trial.emitter();
    if (e.delta()) return evidence;
    const auto lights = static_cast<double>(trial.scene.lights().size());
    Rng rng(hash64({effort.seed, 3}));
    for (int point = 0; point < 4; ++point) {
        const Receiver at = trial.receiver(rng);
        std::array<RunningStatistics, moment_count> sampled, seen;
        for (int i = 0; i < effort.part(4, 1000); ++i) {
            const Light& light = any_light(trial.scene, rng);
            const auto s = e.sample_li(light, at, rng.next_float2());
            const auto g = s ? moments(s->wi) : std::array<double, moment_count>{};
            const double weight =
                s ? lights * static_cast<double>(luminance(s->radiance) / s->pdf) : 0;
            for (std::size_t k = 0; k < moment_count; ++k) sampled[k].add(weight * g[k]);
        }
        int met = 0;
        for (int i = 0; i < effort.samples; ++i) {
            const Vector3 w = square_to_uniform_sphere(rng.next_float2());
            const auto radiance = static_cast<double>(luminance(seen_radiance(trial, at.p, w)));
            const auto g = moments(w);
            met += radiance > 0;
            for (std::size_t k = 0; k < moment_count; ++k) {
                seen[k].add(4 * std::numbers::pi * radiance * g[k]);
            }
        }
        if (met < 50) continue;  // too few to judge by
        for (std::size_t k = 0; k < moment_count; ++k) {
            evidence.test(means_agree(sampled[k], seen[k], 1e-4 * std::abs(seen[k].mean())),
                          fmt::format("sampled and met, moment {} from {}", k, text(at.p)));
        }
    }
    return evidence;
}

Evidence emitter_power(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("particles carry the power of the bounds");
    const Emitter& e = trial.emitter();
    double power = 0;
    for (const Light& light : trial.scene.lights()) power += e.bounds(light).power;
    const auto lights = static_cast<double>(trial.scene.lights().size());
    Rng rng(hash64({effort.seed, 5}));
    RunningStatistics carried;
    for (int i = 0; i < effort.samples; ++i) {
        const Light& light = any_light(trial.scene, rng);
        const Vector2 u = rng.next_float2(), v = rng.next_float2();
        const auto particle = e.sample_emission(light, u, v);
        carried.add(particle ? static_cast<double>(luminance(particle->power)) * lights : 0);
    }
    evidence.test(mean_is(carried, power, 0.015 * power), "W");
    return evidence;
}

namespace {

std::size_t octant_of(Vector3 n) {
    return static_cast<std::size_t>((n.x > 0) + 2 * (n.y > 0) + 4 * (n.z > 0));
}

}  // namespace

Evidence emitter_photons(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("particles bring the light that is sampled");
    const Emitter& e = trial.emitter();
    const auto lights = static_cast<double>(trial.scene.lights().size());
    std::array<RunningStatistics, 8> brought, sampled;
    std::array<int, 9> hits{};
    double carried = 0;
    Rng rng(hash64({effort.seed, 6}));
    const auto add = [](auto& sums, std::size_t octant, double value) {
        for (std::size_t k = 0; k < 8; ++k) sums[k].add(k == octant ? value : 0.0);
    };
    const double area = 4 * std::numbers::pi * sqr(static_cast<double>(trial.radius));
    for (int i = 0; i < effort.samples; ++i) {
        const Light& light = any_light(trial.scene, rng);
        const Vector2 u = rng.next_float2(), v = rng.next_float2();
        const auto particle = e.sample_emission(light, u, v);
        const auto n = particle ? trial.entry(particle->ray) : std::nullopt;
        const double power = particle ? static_cast<double>(luminance(particle->power)) : 0;
        carried += power * lights / effort.samples;
        ++hits[n ? octant_of(*n) : 8];
        add(brought, n ? octant_of(*n) : 8, power * lights);

        const Vector3 outward = square_to_uniform_sphere(rng.next_float2());
        const Receiver at{.p = trial.center + trial.radius * outward, .n = outward, .ns = outward};
        const Light& other = any_light(trial.scene, rng);
        const auto s = e.sample_li(other, at, rng.next_float2());
        const float cosine = s ? std::max(glm::dot(s->wi, outward), 0.0f) : 0;
        add(sampled, octant_of(outward),
            s ? lights * area * static_cast<double>(luminance(s->radiance) * cosine / s->pdf) : 0);
    }
    for (std::size_t k = 0; k < 8; ++k) {
        // What few particles reach is too far from normal to be judged.
        constexpr double few = 50;
        if (hits[k] < few && sampled[k].mean() < few * carried / effort.samples) continue;
        evidence.test(means_agree(brought[k], sampled[k], 1e-3 * sampled[k].mean()),
                      fmt::format("W brought and sampled in octant {} of a ball at {}", k,
                                  text(trial.center)));
    }
    return evidence;
}

Evidence emitter_bounds(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("emission stays inside the bounds");
    const Emitter& e = trial.emitter();
    if (e.infinite()) return evidence;
    Rng rng(hash64({effort.seed, 7}));
    for (int i = 0; i < effort.part(10); ++i) {
        const Light& light = any_light(trial.scene, rng);
        const Vector2 u = rng.next_float2(), v = rng.next_float2();
        const auto particle = e.sample_emission(light, u, v);
        if (!particle || is_black(particle->power)) continue;
        const LightBounds b = e.bounds(light);
        const Vector3 margin(1e-5f * (1 + max_component(absolute(particle->ray.o))));
        evidence.require(
            Bounds3{b.box.min - margin, b.box.max + margin}.contains(particle->ray.o),
            [&] { return "a particle starts outside of the box at " + text(particle->ray.o); });
        float cosine = glm::dot(particle->ray.d, b.axis);
        if (b.two_sided) cosine = std::abs(cosine);
        const float widest = std::acos(b.cos_normals) + std::acos(b.cos_emission);
        evidence.require(std::acos(std::clamp(cosine, -1.0f, 1.0f)) <= widest + 1e-3f, [&] {
            return "a particle leaves the cone along " + text(particle->ray.d);
        });
    }
    return evidence;
}

Evidence emitter_lanes(const EmitterTrial& trial, const Effort& effort) {
    Evidence evidence("many particles at once are each by itself");
    const Emitter& e = trial.emitter();
    Rng rng(hash64({effort.seed, 8}));
    for (std::size_t count = 1; count <= lane_count; ++count) {
        const Light& light = any_light(trial.scene, rng);
        Vector2Lanes u{}, v{};
        for (std::size_t i = 0; i < count; ++i) {
            u.set(i, rng.next_float2());
            v.set(i, rng.next_float2());
        }
        EmissionLanes lanes;
        e.batch().sample_emission(e, light, u, v, count, lanes);
        for (std::size_t i = 0; i < count; ++i) {
            const auto one = e.sample_emission(light, u[i], v[i]);
            const bool same = one ? lanes.power[i] == one->power && lanes.o[i] == one->ray.o &&
                                        lanes.d[i] == one->ray.d
                                  : is_black(lanes.power[i]);
            evidence.require(same, [&] { return fmt::format("lane {} of {} differs", i, count); });
        }
    }
    return evidence;
}

std::vector<Evidence> check(const EmitterTrial& trial, const Effort& effort) {
    return {emitter_nature(trial, effort),    emitter_extreme_numbers(trial),
            emitter_densities(trial, effort), emitter_coverage(trial, effort),
            emitter_power(trial, effort),     emitter_photons(trial, effort),
            emitter_bounds(trial, effort),    emitter_lanes(trial, effort)};
}

}  // namespace lucerna::contracts
