// SPDX-License-Identifier: Apache-2.0
/// How near the path tracer comes to what Embree allows: renders diffuse scenes with `path`,
/// records every ray, replays the very same rays through bare Embree calls on the same scene, and
/// compares the rates; then renders on two threads. One scene is open and coarse, so that rays are
/// as cheap as they get; the other is closed and has a million triangles.
///
///     ray_throughput_benchmark [rounds]
///
/// Rays that the renderer traces in packets are replayed one by one, too, so that more than 100 %
/// is possible. The program defines rtcIntersect1, rtcOccluded1 and rtcOccluded16 itself, so that
/// the calls of the core library pass through it: nothing in the renderer knows of the recording.
#include "core/description/xml_reader.h"
#include "core/scene/builder.h"
#include "core/scene/embree.h"
#include "tests/benchmarks/benchmark_scenes.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace {

struct RecordedRay {
    RTCRay ray;
    bool occlusion;
};

std::vector<RecordedRay>* recording = nullptr;
RTCScene recorded_scene = nullptr;

void record(RTCScene scene, const RTCRay& ray, bool occlusion) {
    if (!recording) return;
    recorded_scene = scene;
    recording->push_back({ray, occlusion});
}

void record(RTCScene scene, const int* valid, const RTCRay16& rays) {
    if (!recording) return;
    for (std::size_t i = 0; i < 16; ++i) {
        if (valid[i] == 0) continue;
        RTCRay ray{};
        ray.org_x = rays.org_x[i], ray.org_y = rays.org_y[i], ray.org_z = rays.org_z[i];
        ray.dir_x = rays.dir_x[i], ray.dir_y = rays.dir_y[i], ray.dir_z = rays.dir_z[i];
        ray.tnear = rays.tnear[i], ray.tfar = rays.tfar[i];
        ray.time = rays.time[i];
        ray.mask = rays.mask[i];
        ray.id = rays.id[i];
        ray.flags = rays.flags[i];
        record(scene, ray, true);
    }
}

template <typename Function>
Function* embree_function(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

#pragma GCC visibility push(default)  // or the core library would not find them
#if RTC_VERSION_MAJOR >= 4

extern "C" void rtcIntersect1(RTCScene scene, RTCRayHit* ray, RTCIntersectArguments* arguments) {
    static auto* const real =
        embree_function<void(RTCScene, RTCRayHit*, RTCIntersectArguments*)>("rtcIntersect1");
    record(scene, ray->ray, false);
    real(scene, ray, arguments);
}

extern "C" void rtcOccluded1(RTCScene scene, RTCRay* ray, RTCOccludedArguments* arguments) {
    static auto* const real =
        embree_function<void(RTCScene, RTCRay*, RTCOccludedArguments*)>("rtcOccluded1");
    record(scene, *ray, true);
    real(scene, ray, arguments);
}

extern "C" void rtcOccluded16(const int* valid, RTCScene scene, RTCRay16* rays,
                              RTCOccludedArguments* arguments) {
    static auto* const real =
        embree_function<void(const int*, RTCScene, RTCRay16*, RTCOccludedArguments*)>(
            "rtcOccluded16");
    record(scene, valid, *rays);
    real(valid, scene, rays, arguments);
}

namespace {

void bare_intersect(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray, nullptr); }
void bare_occluded(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, nullptr); }

}  // namespace

#else

extern "C" void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* ray) {
    static auto* const real =
        embree_function<void(RTCScene, RTCIntersectContext*, RTCRayHit*)>("rtcIntersect1");
    record(scene, ray->ray, false);
    real(scene, context, ray);
}

extern "C" void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
    static auto* const real =
        embree_function<void(RTCScene, RTCIntersectContext*, RTCRay*)>("rtcOccluded1");
    record(scene, *ray, true);
    real(scene, context, ray);
}

extern "C" void rtcOccluded16(const int* valid, RTCScene scene, RTCIntersectContext* context,
                              RTCRay16* rays) {
    static auto* const real =
        embree_function<void(const int*, RTCScene, RTCIntersectContext*, RTCRay16*)>(
            "rtcOccluded16");
    record(scene, valid, *rays);
    real(valid, scene, context, rays);
}

namespace {

void bare_intersect(RTCScene scene, RTCRayHit* ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray);
}

void bare_occluded(RTCScene scene, RTCRay* ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, ray);
}

}  // namespace

#endif
#pragma GCC visibility pop

namespace lucerna {

namespace {

constexpr std::uint64_t samples = 8;

/// Processor seconds of this process: other work on the machine does not count.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double render_processor_seconds(const Scene& scene) {
    const double start = processor_seconds();
    render_seconds(scene, 1, samples);
    return processor_seconds() - start;
}

double replay_processor_seconds(const std::vector<RecordedRay>& rays) {
    const double start = processor_seconds();
    for (const RecordedRay& recorded : rays) {
        if (recorded.occlusion) {
            RTCRay ray = recorded.ray;
            bare_occluded(recorded_scene, &ray);
        } else {
            RTCRayHit ray;
            ray.ray = recorded.ray;
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            bare_intersect(recorded_scene, &ray);
        }
    }
    return processor_seconds() - start;
}

void run(const char* name, const std::string& text, int rounds) {
    Diagnostics diagnostics;
    const Description description = read_scene_text(text, name, {}, diagnostics);
    diagnostics.throw_if_errors();
    Registry registry;
    const auto scene = build_scene(description, registry, diagnostics);

    std::vector<RecordedRay> rays;
    rays.reserve(8'000'000);
    recording = &rays;
    render_seconds(*scene, 1, samples);
    recording = nullptr;
    const double millions = static_cast<double>(rays.size()) / 1e6;
    fmt::print("{}: {:.2f} million rays, {:.0f} % of them shadow rays\n", name, millions,
               100.0 *
                   static_cast<double>(std::count_if(rays.begin(), rays.end(),
                                                     [](const auto& r) { return r.occlusion; })) /
                   static_cast<double>(rays.size()));

    // In turn, so that a machine whose speed drifts slows all of them.
    std::vector<double> one, two, bare, share, scaling;
    for (int i = 0; i < rounds; ++i) {
        one.push_back(render_processor_seconds(*scene));
        bare.push_back(replay_processor_seconds(rays));
        share.push_back(bare.back() / one.back());
        const double single = render_seconds(*scene, 1, samples);
        two.push_back(render_seconds(*scene, 2, samples));
        scaling.push_back(single / two.back());
    }
    fmt::print("bare Embree, 1 thread   {:6.2f} Mrays/s\n", millions / median(bare));
    fmt::print("path, 1 thread          {:6.2f} Mrays/s   {:.0f} % of Embree\n",
               millions / median(one), 100 * median(share));
    fmt::print("path, 2 threads         {:6.2f} Mrays/s   {:.2f} x one thread\n",
               millions / median(two), median(scaling));
}

}  // namespace

}  // namespace lucerna

int main(int argc, char** argv) {
    try {
        const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
        const auto folder = std::filesystem::temp_directory_path() / "lucerna_ray_throughput";
        std::filesystem::create_directories(folder);
        lucerna::run("city", lucerna::diffuse_city(), rounds);
        lucerna::run("room", lucerna::diffuse_room(folder), rounds);
        std::filesystem::remove_all(folder);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
