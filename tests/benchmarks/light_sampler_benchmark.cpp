// SPDX-License-Identifier: Apache-2.0
/// How much noise the choice of lights makes: the exact variance of one sample, for every light
/// sampler there is, at points of a city at night, by evaluating all lights at each point.
///
///     light_sampler_benchmark [lights [points [aerial | street [sampler…]]]]
///
/// A sampler is a type, and parameters after it: cache:lights=128:jitter=0.5.
/// Printed are means over the points of the relative variance, cut at 10⁴, its median and 90 %
/// quantile (plugins/commands/compare/light_oracle.h explains them and the bound), the number of
/// points at which a light that contributes is never drawn, and the time of a choice and of a
/// probability.
#include "plugins/commands/compare/light_oracle.h"
#include "tests/benchmarks/benchmark_samplers.h"

#include <cstdio>
#include <cstdlib>

namespace lucerna {
namespace {

/// Blocks of 25 m with houses, lamps over the streets, and windows 5 cm in front of the walls.
std::string night_city(int lights, const std::string& view) {
    const int side = std::max(6, static_cast<int>(std::sqrt(lights / 8.7)));
    const double width = 25.0 * side;
    Rng rng(1);
    const auto number = [&](double a, double b) { return a + (b - a) * rng.next_double(); };
    const std::string camera =
        view == "street" ? fmt::format("origin='0.5,2.5,{}' target='0,6,0'", -0.45 * width)
                         : fmt::format("origin='{},{},{}' target='0,0,0'", 0.45 * width,
                                       0.35 * width, -0.5 * width);
    std::string text = fmt::format(
        "<scene version='3.0.0'><integrator type='direct'/><sensor type='perspective'>"
        "<float name='fov' value='50'/><transform name='to_world'><lookat {} up='0,1,0'/>"
        "</transform><film type='hdrfilm'><integer name='width' value='640'/>"
        "<integer name='height' value='360'/></film></sensor>"
        "<bsdf type='diffuse' id='b'><rgb name='reflectance' value='0.5'/></bsdf>"
        "<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>"
        "<scale value='{}'/></transform><ref id='b'/></shape>",
        camera, width);
    std::vector<Vector3d> houses;  // middle and height
    for (int i = 0; i < side * side; ++i) {
        const double x = 25 * (i % side - 0.5 * (side - 1)), z = 25 * (i / side - 0.5 * (side - 1));
        const double h = 8 + 55 * std::pow(rng.next_double(), 3);
        houses.push_back({x + 12.5, h, z});
        text += fmt::format(
            "<shape type='cube'><transform name='to_world'><scale x='8' y='{}' z='8'/>"
            "<translate x='{}' y='{}' z='{}'/></transform><ref id='b'/></shape>",
            h / 2, x + 12.5, h / 2, z);
    }
    for (int i = 0; i < lights; ++i) {
        const Vector3d house = houses[rng.next_uint() % houses.size()];
        const bool lamp = rng.next_double() < 0.35;
        const double along = number(-7, 7), u = rng.next_double();
        const int wall = static_cast<int>(rng.next_uint() % 4);
        const double out = lamp ? 10.5 : 8.05;
        Vector3d p(house.x, lamp ? 6 : number(1.5, house.y - 1), house.z);
        p[wall % 2 == 0 ? 0 : 2] += wall < 2 ? out : -out;
        p[wall % 2 == 0 ? 2 : 0] += along;
        const double radiance = lamp ? 400 : 2 * std::pow(20, u);
        const double angle = wall == 0 ? 90 : wall == 1 ? 0 : wall == 2 ? -90 : 180;
        text += fmt::format(
            "<shape type='rectangle'><transform name='to_world'><scale value='{}'/>"
            "<rotate {}='1' angle='{}'/><translate x='{:.3f}' y='{:.3f}' z='{:.3f}'/></transform>"
            "<emitter type='area'><rgb name='radiance' value='{:.3f}'/></emitter></shape>",
            lamp ? 0.15 : 0.6, lamp ? "x" : "y", lamp ? 90.0 : angle, p.x, p.y, p.z, radiance);
    }
    return text + "</scene>";
}

void print_row(const std::string& name, const OracleFigures& f, double ns, double pmf_ns,
               double build) {
    std::printf("%-36s %10.4g %10.4g %10.4g %6u %9.0f %9.0f %8.2f\n", name.c_str(), f.mean,
                f.median, f.upper, f.blind, ns, pmf_ns, build);
    std::fflush(stdout);
}

void measure(const std::string& type, const Scene& scene, const OracleKind& points) {
    auto start = BenchmarkClock::now();
    const PreparedSampler built(element_of(type), scene);
    const double build = seconds_since(start);
    const LightSampler& sampler = *built;
    start = BenchmarkClock::now();
    const OracleFigures figures = points.judge(sampler);
    double probabilities = 0;
    for (const LightMoments& m : points.moments()) {
        probabilities += static_cast<double>(m.entries.size());
    }
    const double pmf_ns = 1e9 * seconds_since(start) / probabilities;
    start = BenchmarkClock::now();
    const int repeats = type == "exhaustive" ? 1 : 200;
    std::uint32_t sink = 0;
    Rng rng(3);
    for (int i = 0; i < repeats; ++i) {
        for (const LightMoments& m : points.moments()) {
            Receiver at = m.at;
            at.p.x += 1e-6f * static_cast<float>(i) * at.p.x;
            if (const auto choice = sampler.at(at).sample(rng.next_double())) sink += choice->light;
        }
    }
    const double ns =
        1e9 * seconds_since(start) / (repeats * static_cast<double>(points.moments().size()));
    if (sink == 1) std::printf(" ");
    print_row(type, figures, ns, pmf_ns, build);
}

int run(int argc, char** argv) {
    const int lights = argc > 1 ? std::atoi(argv[1]) : 5000;
    const auto count = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 200);
    const std::string view = argc > 3 ? argv[3] : "aerial";
    Registry registry;
    Diagnostics diagnostics;
    const Description description =
        read_scene_text(night_city(lights, view), "city.xml", {}, diagnostics);
    const std::unique_ptr<Scene> scene = build_scene(description, registry, diagnostics);
    diagnostics.throw_if_errors();
    const OracleOptions options = OracleOptions::for_lights(scene->lights().size(), count);
    const OracleKind points(
        evaluate_all(*scene, options, oracle_points(*scene, 0, options.points, 99)));
    std::printf("%zu lights, %s, %zu points\n", scene->lights().size(), view.c_str(),
                points.moments().size());
    std::printf("%-36s %10s %10s %10s %6s %9s %9s %8s\n", "sampler", "variance", "median", "90 %",
                "blind", "sample ns", "pmf ns", "build s");
    print_row("(bound)", points.bound(), 0, 0, 0);
    print_row("(no shadows)", points.unoccluded(), 0, 0, 0);
    std::vector<std::string> types(argv + std::min(argc, 4), argv + argc);
    if (types.empty()) types = registry.names(LightSampler::kind);
    for (const std::string& type : types) {
        measure(type, *scene, points);
    }
    return 0;
}

}  // namespace
}  // namespace lucerna

int main(int argc, char** argv) { return lucerna::run(argc, argv); }
