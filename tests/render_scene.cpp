// SPDX-License-Identifier: Apache-2.0
#include "tests/render_scene.h"

#include "core/description/xml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

namespace lucerna {

TestScene::TestScene(const std::string& content, const std::filesystem::path& folder)
    : TestScene(content, Registry(), folder) {}

TestScene::TestScene(const std::string& content, Registry registry,
                     const std::filesystem::path& folder)
    : registry_(std::move(registry)) {
    const Description description =
        read_scene_text("<scene version='3.0.0'>" + content + "</scene>",
                        (folder / "test.xml").string(), {}, diagnostics_);
    diagnostics_.throw_if_errors();
    scene_ = build_scene(description, registry_, diagnostics_);
}

std::string TestScene::warnings() const {
    std::string text;
    for (const Diagnostic& d : diagnostics_.all()) text += d.message + "\n";
    return text;
}

FilmState TestScene::render(const Samples& samples) const {
    RenderOptions options;
    options.budget.samples = samples.per_pixel;
    options.seed = samples.seed;
    options.threads = samples.threads;
    RenderJob job(*scene_, std::move(options), FilmState(film_layout(*scene_)));
    scene_->integrator().render(job);
    return job.take_state();
}

std::string xml(const TestCamera& c) {
    const std::string view = c.type == "orthographic" ? "" : number("fov", c.fov);
    return fmt::format(
        "<sensor type='{}'>{}{}{}{}<transform name='to_world'>{}</transform>"
        "<film type='hdrfilm'>{}{}<rfilter type='{}'/></film><sampler type='{}'/></sensor>",
        c.type, c.inside, view, number("near_clip", c.near_clip), number("far_clip", c.far_clip),
        c.to_world, integer("width", c.width), integer("height", c.height), c.rfilter, c.sampler);
}

std::string text_of(Vector3d v) { return fmt::format("{}, {}, {}", v.x, v.y, v.z); }

std::string look(Vector3d from, Vector3d at) {
    const Vector3d d = absolute(at - from);
    const Vector3d up = d.y > 0.9 * glm::length(d) ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
    return fmt::format("<lookat origin='{}' target='{}' up='{}'/>", text_of(from), text_of(at),
                       text_of(up));
}

std::string probe(Vector3d p, Vector3d n, double distance) {
    const TestCamera camera{.to_world = look(p + distance * glm::normalize(n), p),
                            .near_clip = 0.02 * distance};
    return xml(camera);
}

std::string translate(Vector3d by) { return fmt::format("<translate value='{}'/>", text_of(by)); }

std::string scale(double factor) { return fmt::format("<scale value='{}'/>", factor); }

std::string shape(const std::string& type, const std::string& to_world, const std::string& inside) {
    return fmt::format("<shape type='{}'><transform name='to_world'>{}</transform>{}</shape>", type,
                       to_world, inside);
}

std::string sphere(Vector3d center, double radius, const std::string& inside) {
    return fmt::format("<shape type='sphere'><point name='center' value='{}'/>{}{}</shape>",
                       text_of(center), number("radius", radius), inside);
}

std::string diffuse(double reflectance) {
    return fmt::format("<bsdf type='diffuse'><rgb name='reflectance' value='{}'/></bsdf>",
                       reflectance);
}

std::string area_light(double radiance) {
    return fmt::format("<emitter type='area'><rgb name='radiance' value='{}'/></emitter>",
                       radiance);
}

std::string constant_light(double radiance) {
    return fmt::format("<emitter type='constant'><rgb name='radiance' value='{}'/></emitter>",
                       radiance);
}

std::string point_light(Vector3d position, double intensity) {
    return fmt::format(
        "<emitter type='point'><point name='position' value='{}'/>"
        "<rgb name='intensity' value='{}'/></emitter>",
        text_of(position), intensity);
}

std::string path_integrator(const std::string& inside) {
    std::string all = inside;
    const std::pair<const char*, int> simplest[] = {
        {"reuse", 1}, {"emitter_samples", 1}, {"specular_chain", 0}};
    for (const auto& [name, value] : simplest) {
        if (inside.find(fmt::format("'{}'", name)) != std::string::npos) continue;
        all += integer(name, value);
    }
    return "<integrator type='path'>" + all + "</integrator>";
}

std::string direct_integrator(const std::string& inside) {
    return "<integrator type='direct'>" + inside + "</integrator>";
}

std::string integer(const std::string& name, std::int64_t value) {
    return fmt::format("<integer name='{}' value='{}'/>", name, value);
}

std::string number(const std::string& name, double value) {
    return fmt::format("<float name='{}' value='{}'/>", name, value);
}

std::string boolean(const std::string& name, bool value) {
    return fmt::format("<boolean name='{}' value='{}'/>", name, value);
}

std::string sphere_obj(int n, bool smooth) {
    std::string text, corners;
    const int columns = 2 * n;
    const auto vertex = [&](double theta, double phi) {
        const Vector3d p(std::sin(theta) * std::cos(phi), std::cos(theta),
                         std::sin(theta) * std::sin(phi));
        text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
        if (smooth) text += fmt::format("vn {} {} {}\n", p.x, p.y, p.z);
    };
    // Turned by odd angles, so that no edge lies along an axis.
    for (int row = 1; row < n; ++row) {
        for (int column = 0; column < columns; ++column) {
            vertex(std::numbers::pi * row / n, 0.1 + 2 * std::numbers::pi * column / columns);
        }
    }
    vertex(0, 0);
    vertex(std::numbers::pi, 0);
    const auto index = [&](int row, int column) {
        if (row == 0) return columns * (n - 1) + 1;
        if (row == n) return columns * (n - 1) + 2;
        return columns * (row - 1) + column % columns + 1;
    };
    const auto face = [&](int a, int b, int c) {
        corners += smooth ? fmt::format("f {0}//{0} {1}//{1} {2}//{2}\n", a, b, c)
                          : fmt::format("f {} {} {}\n", a, b, c);
    };
    for (int row = 0; row < n; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int a = index(row, column), b = index(row, column + 1);
            const int c = index(row + 1, column), d = index(row + 1, column + 1);
            if (row > 0) face(a, b, c);
            if (row < n - 1) face(b, d, c);
        }
    }
    return text + corners;
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

std::vector<double> numbers_of(const FilmState& film) {
    std::vector<double> result;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        for (std::size_t c = 0; c < film.channel_count(); ++c) result.push_back(film.mean(i, c));
    }
    return result;
}

RunningStatistics pixel_statistics(const FilmState& film, std::size_t channel) {
    RunningStatistics result;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) result.add(film.mean(i, channel));
    return result;
}

Interval pixel_range(const FilmState& film, std::size_t channel) {
    Interval range{film.mean(0, channel), film.mean(0, channel)};
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        const double value = film.mean(i, channel);
        range = {std::min(range.low, value), std::max(range.high, value)};
    }
    return range;
}

namespace {

constexpr double float_tolerance = 2e-5;

testing::AssertionResult judge(double value, double reference, double error, double precision) {
    const double relative = error / std::abs(reference);
    const std::string figures =
        fmt::format("{} ± {:.2g} against {}: {:.3g} standard errors", value, error, reference,
                    (value - reference) / std::max(error, 1e-300));
    if (!(relative <= precision)) {
        return testing::AssertionFailure()
               << figures << "; too noisy: " << relative << " > " << precision;
    }
    if (!(std::abs(value - reference) <= 4 * error + float_tolerance * std::abs(reference))) {
        return testing::AssertionFailure() << figures;
    }
    return testing::AssertionSuccess() << figures;
}

}  // namespace

RunningStatistics image_means(const std::string& content, std::uint64_t samples, int images) {
    const TestScene scene(content);
    RunningStatistics result;
    for (int i = 0; i < images; ++i) {
        const FilmState film =
            scene.render({.per_pixel = samples, .seed = static_cast<std::uint64_t>(i)});
        EXPECT_EQ(film.dropped_samples(), 0u);
        result.add(pixel_statistics(film).mean());
    }
    return result;
}

testing::AssertionResult agrees(const RunningStatistics& x, double reference, double precision) {
    return judge(x.mean(), reference, x.standard_error(), precision);
}

testing::AssertionResult agree(const RunningStatistics& a, const RunningStatistics& b,
                               double precision) {
    return judge(a.mean(), b.mean(), std::hypot(a.standard_error(), b.standard_error()),
                 std::sqrt(2.0) * precision);
}

testing::AssertionResult is_constant(const FilmState& film, double value, double tolerance) {
    if (film.dropped_samples() > 0) {
        return testing::AssertionFailure() << film.dropped_samples() << " samples are not finite";
    }
    for (std::size_t c = 0; c < 3; ++c) {
        const Interval range = pixel_range(film, c);
        if (!(range.low >= value - tolerance * std::abs(value)) ||
            !(range.high <= value + tolerance * std::abs(value))) {
            return testing::AssertionFailure()
                   << fmt::format("pixels are in [{}, {}], not {}", range.low, range.high, value);
        }
    }
    return testing::AssertionSuccess();
}

double polygon_irradiance(std::vector<Vector3d> vertices, Vector3d p, Vector3d n) {
    n = glm::normalize(n);
    std::vector<Vector3d> above;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vector3d a = vertices[i] - p, b = vertices[(i + 1) % vertices.size()] - p;
        const double height_a = glm::dot(a, n), height_b = glm::dot(b, n);
        if (height_a >= 0) above.push_back(a);
        if (height_a * height_b < 0)
            above.push_back(a + height_a / (height_a - height_b) * (b - a));
    }
    double sum = 0;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const Vector3d a = glm::normalize(above[i]);
        const Vector3d b = glm::normalize(above[(i + 1) % above.size()]);
        const Vector3d normal = glm::cross(a, b);
        const double sine = glm::length(normal);
        if (sine > 0) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal / sine, n);
    }
    return std::abs(sum) / 2;
}

}  // namespace lucerna
