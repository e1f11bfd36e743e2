// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/check/pictures.h"

#include "plugins/commands/check/panel.h"
#include "plugins/commands/contracts/bsdf.h"
#include "plugins/commands/contracts/emitter.h"
#include "plugins/commands/contracts/light_sampler.h"
#include "plugins/commands/contracts/light_scenes.h"
#include "plugins/commands/contracts/shape.h"

#include "core/interfaces/film.h"
#include "core/interfaces/phase.h"
#include "core/math/warp.h"

namespace lucerna {

namespace {

using Sheet = std::vector<std::vector<Panel>>;

constexpr int sphere_width = 160, sphere_height = 80;

/// Adds a direction to a map of the sphere: azimuth to the right, cosine upwards, areas equal.
void add_direction(Field& field, Vector3 w, double value) {
    const double turn = std::atan2(w.y, w.x) / (2 * std::numbers::pi);
    field.add(turn < 0 ? turn + 1 : turn, 0.5 * (static_cast<double>(w.z) + 1) * (1 - 1e-7), value);
}

/// A map of the sphere of a function of direction.
Field sphere_map(const std::function<double(Vector3)>& f) {
    Field field(sphere_width, sphere_height);
    for (int y = 0; y < sphere_height; ++y) {
        for (int x = 0; x < sphere_width; ++x) {
            const auto z = static_cast<float>(1 - 2 * (y + 0.5) / sphere_height);
            const auto phi = static_cast<float>(2 * std::numbers::pi * (x + 0.5) / sphere_width);
            field.at(x, y) = f(contracts::local_direction(z, phi));
        }
    }
    return field;
}

/// Samples as a density [1/sr].
constexpr double per_sample(int samples) {
    return sphere_width * sphere_height / (4 * std::numbers::pi * samples);
}

/// Directions that are drawn, if any, their density, and what is scattered.
std::vector<Panel> lobe_row(const std::function<std::optional<Vector3>(Rng&)>& draw,
                            const std::function<double(Vector3)>& pdf,
                            const std::function<double(Vector3)>& value, const Effort& effort) {
    Field drawn(sphere_width, sphere_height);
    Rng rng(effort.seed);
    for (int i = 0; i < effort.samples; ++i) {
        const std::optional<Vector3> wi = draw(rng);
        if (wi) add_direction(drawn, *wi, per_sample(effort.samples));
    }
    const Field density = sphere_map(pdf), scattered = sphere_map(value);
    const double white = density.largest() > 0 ? density.largest() : drawn.largest();
    return {drawn.show(white), density.show(white), scattered.show(scattered.largest())};
}

Sheet draw_bsdf(const BSDF& bsdf, const Effort& effort) {
    Sheet sheet;
    const Interaction at = contracts::bsdf_surface();
    constexpr TransportMode mode = TransportMode::radiance;
    for (const float cosine : {0.95f, 0.5f, -0.6f}) {
        const Vector3 wo = contracts::local_direction(cosine, 2.3f);
        const auto draw = [&](Rng& rng) -> std::optional<Vector3> {
            const auto s = contracts::draw(bsdf, at, wo, mode, rng);
            return s ? std::optional(s->wi) : std::nullopt;
        };
        const auto pdf = [&](Vector3 wi) {
            return static_cast<double>(bsdf.evaluate(at, wo, wi, mode).pdf);
        };
        const auto value = [&](Vector3 wi) {
            const Color f = bsdf.evaluate(at, wo, wi, mode).f;
            return static_cast<double>(luminance(f) * std::abs(wi.z));
        };
        sheet.push_back(lobe_row(draw, pdf, value, effort));
    }
    return sheet;
}

Sheet draw_phase(const Phase& phase, const Effort& effort) {
    Sheet sheet;
    const Vector3 p(0);
    for (const float cosine : {0.95f, 0.5f, -0.6f}) {
        const Vector3 wo = contracts::local_direction(cosine, 2.3f);
        const auto draw = [&](Rng& rng) -> std::optional<Vector3> {
            const float u_lobe = rng.next_float();
            return phase.sample(p, wo, u_lobe, rng.next_float2()).wi;
        };
        const auto pdf = [&](Vector3 wi) {
            return static_cast<double>(phase.evaluate(p, wo, wi).pdf);
        };
        const auto value = [&](Vector3 wi) {
            return static_cast<double>(phase.evaluate(p, wo, wi).f);
        };
        sheet.push_back(lobe_row(draw, pdf, value, effort));
    }
    return sheet;
}

Sheet draw_light_sampler(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make_light_sampler(contracts::courtyard(""));
    const auto& sampler = static_cast<const LightSampler&>(*made.object);
    const auto lights = static_cast<int>(made.scene->lights().size());
    const auto points = contracts::seen_points(*made.scene, 40, effort.seed);
    const auto rows = static_cast<int>(points.size());
    Field drawn(lights, rows), pmf(lights, rows);
    Rng rng(effort.seed);
    const int trials = effort.part(rows, 1000);
    for (int y = 0; y < rows; ++y) {
        const Receiver& at = points[static_cast<std::size_t>(y)];
        const LightDistribution distribution = sampler.at(at);
        for (int i = 0; i < trials; ++i) {
            const auto choice = distribution.sample(rng.next_double());
            if (choice) drawn.at(static_cast<int>(choice->light), y) += 1.0 / trials;
        }
        for (int x = 0; x < lights; ++x) {
            pmf.at(x, y) = static_cast<double>(distribution.pmf(static_cast<std::uint32_t>(x)));
        }
    }
    return {{drawn.show(pmf.largest()), pmf.show(pmf.largest())}};
}

Sheet draw_shape(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make_shape();
    const contracts::ShapeTrial trial(*made.scene);
    const Frame view = Frame::from_normal(glm::normalize(Vector3(1, 0.8f, 1.5f)));
    const Vector3 center = trial.shape.bounds().center();
    const float radius = 1.05f * trial.shape.bounds().radius();
    constexpr int side = 240;
    Field drawn(side, side), expected(side, side);
    const auto pixel = static_cast<double>(sqr(2 * radius / side));
    const int samples = 10 * effort.samples;
    Rng rng(effort.seed);
    for (int i = 0; i < samples; ++i) {
        const auto primitive = rng.next_uint() % trial.shape.primitive_count();
        const SurfaceSample s = trial.shape.sample_area(primitive, rng.next_float2());
        const Vector3 p = view.to_local(s.p - center) / (2 * radius);
        // Primitives are chosen alike, so that each sample stands for its own area.
        const double weight = trial.shape.primitive_count() / static_cast<double>(s.pdf);
        drawn.add(static_cast<double>(p.x) + 0.5, static_cast<double>(p.y) + 0.5,
                  weight / (samples * pixel));
    }
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const Vector3 p(2 * (static_cast<float>(x) + 0.5f) / side - 1,
                            1 - 2 * (static_cast<float>(y) + 0.5f) / side, 1.5f);
            auto hit = trial.meet(center + radius * view.to_world(p), -view.n);
            while (hit) {
                const auto cosine = static_cast<double>(std::abs(glm::dot(hit->n, view.n)));
                expected.at(x, y) += 1 / std::max(cosine, 1e-3);
                hit = trial.scene.intersect(hit->spawn_ray(-view.n));
            }
        }
    }
    return {{drawn.show(6), expected.show(6)}};  // m² of surface to one of the picture
}

Sheet draw_emitter(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make_emitter();
    const contracts::EmitterTrial trial(*made.scene);
    const auto lights = static_cast<std::uint32_t>(trial.scene.lights().size());
    Field particles(sphere_width / 4, sphere_height / 4);
    const int samples = 10 * effort.samples;
    const double cell = 4 * std::numbers::pi * sqr(static_cast<double>(trial.radius)) /
                        (particles.width * particles.height);
    Rng rng(effort.seed);
    for (int i = 0; i < samples; ++i) {
        const Light& light = trial.scene.lights()[rng.next_uint() % lights];
        const Vector2 u = rng.next_float2(), v = rng.next_float2();
        const auto particle = trial.emitter().sample_emission(light, u, v);
        const auto n = particle ? trial.entry(particle->ray) : std::nullopt;
        if (!n) continue;
        add_direction(particles, *n,
                      lights * static_cast<double>(luminance(particle->power)) / (samples * cell));
    }
    const Field irradiance = sphere_map([&](Vector3 n) {
        const Receiver at{.p = trial.center + trial.radius * n, .n = n, .ns = n};
        double sum = 0;
        for (int i = 0; i < 16; ++i) {
            const Light& light = trial.scene.lights()[rng.next_uint() % lights];
            const auto s = trial.emitter().sample_li(light, at, rng.next_float2());
            const float cosine = s ? std::max(glm::dot(s->wi, n), 0.0f) : 0;
            if (s) sum += static_cast<double>(luminance(s->radiance) * cosine / s->pdf) * lights;
        }
        return sum / 16;
    });
    const double white = irradiance.largest();
    return {{particles.show(white), irradiance.show(white)}};
}

Sheet draw_texture(const Texture& texture) {
    const int width = 240, height = std::max(1, static_cast<int>(240 / texture.aspect()));
    Panel panel(width, std::min(height, 960));
    for (int y = 0; y < panel.height; ++y) {
        for (int x = 0; x < width; ++x) {
            panel.at(x, y) = texture.color(
                {(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(panel.height)});
        }
    }
    return {{panel}};
}

Sheet draw_rfilter(const RFilter& filter) {
    constexpr int width = 240, height = 160, zero = 120;
    Panel panel(width, height);
    const float scale = zero / std::max(filter.evaluate(0), 1e-20f) * 0.95f;
    for (int x = 0; x < width; ++x) {
        const float place = (2 * (static_cast<float>(x) + 0.5f) / width - 1) * filter.radius();
        const int top = zero - static_cast<int>(scale * filter.evaluate(place));
        for (int y = std::min(top, zero); y <= std::max(top, zero); ++y) {
            if (y >= 0 && y < height) panel.at(x, y) = Color(1, 0.5f, 0.1f);
        }
    }
    return {{panel}};
}

Sheet draw_sampler(const Sampler& sampler) {
    Sheet sheet;
    for (const bool along : {true, false}) {
        std::vector<Panel> row;
        for (const std::uint32_t dimension : {0u, 2u, 34u}) {
            Panel panel(240, 240);
            for (std::uint64_t i = 0; i < 1024; ++i) {
                const Vector2 p =
                    along ? sampler.sample_2d(1, i, dimension) : sampler.sample_2d(i, 0, dimension);
                panel.at(static_cast<int>(p.x * 240), 239 - static_cast<int>(p.y * 240)) = Color(1);
            }
            row.push_back(std::move(panel));
        }
        sheet.push_back(std::move(row));
    }
    return sheet;
}

Sheet draw_sensor(const Sensor& sensor) {
    const Vector2 film(sensor.film().size());
    const int width = 240;
    const int height = std::clamp(static_cast<int>(240 * film.y / film.x), 1, 960);
    Field importance(width, height);
    Panel directions(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Vector2 place((static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                                (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
            const Ray ray = sensor.sample_ray(film * place, {0.5f, 0.5f});
            directions.at(x, y) = 0.5f * (ray.d + 1.0f);
            const float t = std::min(4.0f, 0.5f * ray.tmax);
            const auto seen = sensor.connect(ray.o + t * ray.d, {0.5f, 0.5f});
            if (seen) importance.at(x, y) = static_cast<double>(seen->importance);
        }
    }
    return {{importance.show(importance.largest()), directions}};
}

template <typename T>
const T& as(const MadeSubject& made) {
    return static_cast<const T&>(*made.object);
}

Sheet draw(Subject& subject, const Effort& effort) {
    const std::string& kind = subject.kind();
    if (kind == LightSampler::kind) return draw_light_sampler(subject, effort);
    if (kind == Shape::kind) return draw_shape(subject, effort);
    if (kind == Emitter::kind) return draw_emitter(subject, effort);
    const MadeSubject made = subject.make();
    if (kind == BSDF::kind) return draw_bsdf(as<BSDF>(made), effort);
    if (kind == Phase::kind) return draw_phase(as<Phase>(made), effort);
    if (kind == Texture::kind) return draw_texture(as<Texture>(made));
    if (kind == RFilter::kind) return draw_rfilter(as<RFilter>(made));
    if (kind == Sampler::kind) return draw_sampler(as<Sampler>(made));
    return draw_sensor(as<Sensor>(made));
}

}  // namespace

void draw_picture(Subject& subject, const Effort& effort, const std::filesystem::path& path) {
    write_sheet(draw(subject, effort), path);
}

}  // namespace lucerna
