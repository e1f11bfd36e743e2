// SPDX-License-Identifier: Apache-2.0
/// How the cost and the memory of light samplers grow with the number of lights, of places that
/// remember, and of threads, in scenes/city.
///
///     light_growth_benchmark [lights…]        by default 300 5000 100000
///
/// Printed are the wall and processor time to prepare the sampler, the memory that it keeps, and
/// the processor time of one draw, of 64 at once, and of one probability, at points that the camera
/// sees, one after the other, from one thread: the least of five runs.
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "tests/benchmarks/benchmark_samplers.h"
#include "tests/paths.h"

#include <cstdio>
#include <ctime>
#include <functional>
#include <limits>

namespace lucerna {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::unique_ptr<Scene> city(Registry& registry, const std::string& lights, int threads) {
    Diagnostics diagnostics;
    const Description description =
        read_scene(tests_folder().parent_path() / "scenes/city/scene.xml",
                   {.defines = {{"lights", lights}, {"max_depth", "2"}},
                    .overrides = {"integrator.light_sampler=uniform"}},
                   diagnostics);
    std::unique_ptr<Scene> scene =
        build_scene(description, registry, diagnostics, {.threads = threads});
    diagnostics.throw_if_errors();
    return scene;
}

/// Of a run over `count` things: the least of five, in processor time.
double nanoseconds_each(std::size_t count, const std::function<void()>& run) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 5; ++i) {
        const double before = cpu_seconds();
        run();
        least = std::min(least, cpu_seconds() - before);
    }
    return 1e9 * least / static_cast<double>(count);
}

void measure(const std::string& label, const std::string& name, const Scene& scene) {
    const std::vector<Receiver> points =
        pilot_receivers(scene, {.count = 100000, .bounces = 0, .seed = 77}, Workers(1));
    const double cpu = cpu_seconds();
    const auto start = BenchmarkClock::now();
    const PreparedSampler built(element_of(name), scene);
    const double wall = seconds_since(start), build_cpu = cpu_seconds() - cpu;
    const LightSampler& sampler = *built;
    const double kept = static_cast<double>(sampler.bytes()) / 1e6;
    Rng rng(3);
    std::vector<LightDistribution> distributions(points.size());
    std::vector<const Receiver*> receivers;
    std::vector<LightDistribution*> out;
    std::vector<LightDraw> draws;
    for (std::size_t i = 0; i < points.size(); ++i) {
        receivers.push_back(&points[i]);
        out.push_back(&distributions[i]);
        draws.push_back({.lights = &distributions[i], .u = rng.next_double()});
    }
    constexpr std::size_t batch = 64;  // as in `path`
    const double sample_ns = nanoseconds_each(points.size(), [&] {
        for (std::size_t i = 0; i < draws.size(); i += batch) {
            const std::size_t size = std::min(batch, draws.size() - i);
            sampler.batch().at(sampler, std::span(receivers).subspan(i, size),
                               std::span(out).subspan(i, size));
            sampler.batch().sample(sampler, std::span(draws).subspan(i, size));
        }
    });
    float sum = 0;
    const double pmf_ns = nanoseconds_each(points.size(), [&] {
        for (const LightDraw& d : draws) sum += d.lights->pmf(d.choice ? d.choice->light : 0);
    });
    std::printf("%-24s %-32s %9.2f %9.2f %9.1f %9.0f %9.0f%s\n", label.c_str(), name.c_str(), wall,
                build_cpu, kept, sample_ns, pmf_ns, sum < 0 ? "?" : "");
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    std::vector<std::string> counts(argv + 1, argv + argc);
    if (counts.empty()) counts = {"300", "5000", "100000"};
    Registry registry;
    std::printf("%-24s %-32s %9s %9s %9s %9s %9s\n", "", "sampler", "build s", "CPU s", "MB",
                "draw ns", "pmf ns");
    for (const std::string& lights : counts) {
        const auto scene = city(registry, lights, 0);
        for (const char* name : {"power", "bvh", "cache", "cache_kdtree"}) {
            measure(lights + " lights", name, *scene);
        }
    }
    {
        const auto scene = city(registry, "5000", 0);
        for (const int places : {256, 1024, 4096, 16384}) {
            const std::string label = std::to_string(places) + " places";
            measure(label, fmt::format("cache:cell_size=0.002:max_cells={}", places), *scene);
            for (const char* lookup : {"cache_kdtree", "cache_hash", "cache_linear"}) {
                measure(label, fmt::format("{}:max_points={}", lookup, places), *scene);
            }
        }
    }
    for (const int threads : {1, 2}) {
        const auto scene = city(registry, "5000", threads);
        measure(std::to_string(threads) + " threads", "cache", *scene);
    }
    return 0;
}

}  // namespace
}  // namespace lucerna

int main(int argc, char** argv) { return lucerna::run(argc, argv); }
