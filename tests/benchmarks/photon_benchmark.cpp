// SPDX-License-Identifier: Apache-2.0
/// Photons: how fast they are traced, against bare Embree on the very same rays, and how fast they
/// are found, in the k-d tree, in the hash grid and, if its header is installed, in nanoflann.
///
///     photon_benchmark tracing SCENE [rounds]      e.g. scenes/spheres/scene.xml
///     photon_benchmark lookups SCENE [rounds]
///     photon_benchmark memory SCENE [millions]     one map of so many photons, 10 by default
///
/// Each number is the median over rounds in which all rivals take turns; compare within one run.
/// What one thread does is measured in processor time, which other programs disturb less.
#include "core/render/session.h"
#include "core/scene/embree.h"
#include "plugins/integrators/photon_estimate.h"
#include "plugins/integrators/photon_storing.h"

#include <dlfcn.h>
#include <fmt/format.h>
#if __has_include(<nanoflann.hpp>)
#include <nanoflann.hpp>
#define LUCERNA_HAS_NANOFLANN
#endif

#include <chrono>
#include <cstdio>

namespace {

std::vector<RTCRay>* recording = nullptr;
RTCScene recorded_scene = nullptr;

void record(RTCScene scene, const RTCRay& ray) {
    if (!recording) return;
    recorded_scene = scene;
    recording->push_back(ray);
}

template <typename Function>
Function* next_definition(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// The program defines this function itself, so that calls of the core library pass through it.
#pragma GCC visibility push(default)
#if RTC_VERSION_MAJOR >= 4
extern "C" void rtcIntersect1(RTCScene scene, RTCRayHit* ray, RTCIntersectArguments* arguments) {
    static auto* const real =
        next_definition<void(RTCScene, RTCRayHit*, RTCIntersectArguments*)>("rtcIntersect1");
    record(scene, ray->ray);
    real(scene, ray, arguments);
}
#else
extern "C" void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* ray) {
    static auto* const real =
        next_definition<void(RTCScene, RTCIntersectContext*, RTCRayHit*)>("rtcIntersect1");
    record(scene, ray->ray);
    real(scene, context, ray);
}
#endif
#pragma GCC visibility pop

namespace lucerna {

namespace {

using Clock = std::chrono::steady_clock;

template <typename Task>
double seconds(Task&& task) {
    const auto start = Clock::now();
    task();
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of the whole process.
double processor_now() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

template <typename Task>
double processor_seconds(Task&& task) {
    const double start = processor_now();
    task();
    return processor_now() - start;
}

double median(std::vector<double> x) {
    std::nth_element(x.begin(), x.begin() + std::ssize(x) / 2, x.end());
    return x[x.size() / 2];
}

void replay(const std::vector<RTCRay>& rays) {
    for (const RTCRay& ray : rays) {
        RTCRayHit hit;
        hit.ray = ray;
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        embree::intersect(recorded_scene, hit);
    }
}

void measure_tracing(const PhotonTracer& tracer, int rounds) {
    const PhotonPass pass{.key = 1, .count = 400000, .max_depth = 100, .kinds = 7};
    StoredPhotons stored;
    const auto trace = [&](const Workers& workers) {
        stored.photons.clear();
        store_photons(
            tracer, pass, workers, [] { return false; }, stored);
    };
    std::vector<RTCRay> rays;
    recording = &rays;
    trace(Workers(1));
    recording = nullptr;
    std::vector<double> alone, bare, share, gain;
    for (int i = 0; i < rounds; ++i) {
        double wall = 0;
        {
            const Workers one(1);  // not kept: the smallest of those there are would count
            wall = seconds([&] { alone.push_back(processor_seconds([&] { trace(one); })); });
        }
        bare.push_back(processor_seconds([&] { replay(rays); }));
        share.push_back(bare.back() / alone.back());
        const Workers two(2);
        gain.push_back(wall / seconds([&] { trace(two); }));
    }
    const double millions = static_cast<double>(rays.size()) * 1e-6;
    fmt::print("{} photons emitted, {} stored, {:.2f} million rays\n", pass.count,
               stored.photons.size(), millions);
    fmt::print("  bare Embree  {:6.2f} Mrays/s\n", millions / median(bare));
    fmt::print("  photons      {:6.2f} Mrays/s  {:.0f} % of Embree, {:.2f} M stored/s\n",
               millions / median(alone), 100 * median(share),
               static_cast<double>(stored.photons.size()) * 1e-6 / median(alone));
    fmt::print("  two threads  {:.2f} x one (best {:.2f})\n", median(gain),
               *std::max_element(gain.begin(), gain.end()));
}

/// What is asked of a structure: its name, how it is built, how many photons a query finds.
struct Rival {
    std::string name;
    std::function<void()> build;
    std::function<std::size_t(Vector3)> within, nearest;
    std::vector<double> build_seconds = {}, within_seconds = {}, nearest_seconds = {};
    double found = 0;
};

Rival rival(const std::string& name, const std::vector<Photon>& photons, float radius,
            PhotonStructure structure, int k, const Workers& workers) {
    const auto map = std::make_shared<PhotonMap>();
    return {.name = name,
            .build = [=, &photons,
                      &workers] { *map = PhotonMap(photons, 1, structure, radius, workers); },
            .within =
                [=](Vector3 p) {
                    std::size_t count = 0;
                    float radius2 = sqr(radius);
                    map->search(p, radius2, [&](const Photon&, float) { ++count; });
                    return count;
                },
            .nearest =
                [=](Vector3 p) {
                    NearestPhotons nearest(k);
                    float radius2 = structure == PhotonStructure::grid ? sqr(radius) : infinity;
                    map->search(p, radius2, [&](const Photon& photon, float d2) {
                        nearest.add({d2, &photon});
                        if (nearest.full()) radius2 = nearest.farthest2();
                    });
                    return nearest.all().size();
                }};
}

#ifdef LUCERNA_HAS_NANOFLANN
struct Cloud {
    const std::vector<Photon>& photons;
    std::size_t kdtree_get_point_count() const { return photons.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const {
        return photons[i].p()[static_cast<int>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

Rival nanoflann_rival(const std::vector<Photon>& photons, float radius, int k) {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>,
                                                     Cloud, 3, std::uint32_t>;
    const auto cloud = std::make_shared<Cloud>(Cloud{photons});
    const auto tree = std::make_shared<std::unique_ptr<Tree>>();
    return {.name = "nanoflann",
            .build = [=] { *tree = std::make_unique<Tree>(3, *cloud); },
            .within =
                [=](Vector3 p) {
                    static std::vector<std::pair<std::uint32_t, float>> found;
                    nanoflann::SearchParams parameters;
                    parameters.sorted = false;
                    return (*tree)->radiusSearch(&p.x, sqr(radius), found, parameters);
                },
            .nearest =
                [=](Vector3 p) {
                    std::uint32_t indices[PhotonLookup::max_count];
                    float distances[PhotonLookup::max_count];
                    return static_cast<std::size_t>(
                        (*tree)->knnSearch(&p.x, static_cast<std::size_t>(k), indices, distances));
                }};
}
#endif

void measure_lookups(const PhotonTracer& tracer, std::uint64_t emitted, int rounds) {
    constexpr int k = 50, queries = 20000;
    const Workers one(1);
    StoredPhotons stored;
    store_photons(
        tracer, {.key = 2, .count = emitted, .max_depth = 100, .kinds = 7}, one,
        [] { return false; }, stored);
    // At photons in random order: where cameras look, but not the way they look.
    std::vector<Vector3> places;
    Rng rng(1);
    for (int i = 0; i < queries; ++i) {
        const double at = rng.next_double() * static_cast<double>(stored.photons.size());
        places.push_back(stored.photons[static_cast<std::size_t>(at)].p());
    }
    // The radius that holds k photons in the middle of all places.
    const PhotonMap sizes(stored.photons, 1, PhotonStructure::kdtree, 1, one);
    std::vector<double> distances;
    for (std::size_t i = 0; i < 999; ++i) {
        NearestPhotons nearest(k);
        float radius2 = infinity;
        sizes.search(places[i], radius2, [&](const Photon& photon, float d2) {
            nearest.add({d2, &photon});
            if (nearest.full()) radius2 = nearest.farthest2();
        });
        distances.push_back(std::sqrt(static_cast<double>(radius2)));
    }
    const auto radius = static_cast<float>(median(distances));

    std::vector<Rival> rivals;
    rivals.push_back(rival("k-d tree", stored.photons, radius, PhotonStructure::kdtree, k, one));
    rivals.push_back(rival("grid", stored.photons, radius, PhotonStructure::grid, k, one));
#ifdef LUCERNA_HAS_NANOFLANN
    rivals.push_back(nanoflann_rival(stored.photons, radius, k));
#endif
    for (int round = 0; round < rounds; ++round) {
        for (Rival& r : rivals) {
            r.build_seconds.push_back(processor_seconds(r.build));
            std::size_t found = 0;
            r.within_seconds.push_back(processor_seconds([&] {
                for (const Vector3 p : places) found += r.within(p);
            }));
            r.nearest_seconds.push_back(processor_seconds([&] {
                for (const Vector3 p : places) found += r.nearest(p);
            }));
            r.found = static_cast<double>(found) / queries;
        }
    }
    fmt::print("{} photons, 1 thread: build [ms], lookup within r and of {} nearest [µs]\n",
               stored.photons.size(), k);
    for (const Rival& r : rivals) {
        fmt::print("  {:10} {:8.1f} {:8.2f} {:8.2f}{}   {:.0f} found\n", r.name,
                   1e3 * median(r.build_seconds), 1e6 * median(r.within_seconds) / queries,
                   1e6 * median(r.nearest_seconds) / queries, r.name == "grid" ? " (within r)" : "",
                   r.found);
    }
}

/// One map of so many million photons: how long it takes, and what it holds.
void measure_memory(const PhotonTracer& tracer, int millions) {
    const auto wanted = static_cast<std::size_t>(millions) * 1000000;
    const Workers workers;
    StoredPhotons stored;
    stored.photons.reserve(wanted + (1 << 20));
    const double tracing = seconds([&] {
        for (std::uint64_t key = 1; stored.photons.size() < wanted; ++key) {
            store_photons(
                tracer, {.key = key, .count = 1 << 17, .max_depth = 100, .kinds = 7}, workers,
                [] { return false; }, stored);
        }
    });
    stored.photons.resize(wanted);
    stored.photons.shrink_to_fit();
    PhotonMap map;
    const double building = seconds([&] {
        map = PhotonMap(std::move(stored.photons), stored.emitted, PhotonStructure::kdtree, 1,
                        workers);
    });
    fmt::print("{} million photons: traced in {:.2f} s, k-d tree built in {:.2f} s, {:.1f} MB\n",
               millions, tracing, building, static_cast<double>(map.bytes()) * 1e-6);
}

void run(const std::string& part, const char* path, int number) {
    SessionSettings settings;
    settings.scene = path;
    const Session session(settings);
    const PhotonTracer tracer(session.scene());
    if (tracer.dark()) throw std::runtime_error("the scene has no light");
    if (part == "tracing") {
        measure_tracing(tracer, number > 0 ? number : 9);
    } else if (part == "lookups") {
        for (const std::uint64_t emitted : {40000u, 400000u}) {
            measure_lookups(tracer, emitted, number > 0 ? number : 5);
        }
    } else if (part == "memory") {
        measure_memory(tracer, number > 0 ? number : 10);
    } else {
        throw std::runtime_error(part + " is none of tracing, lookups, memory");
    }
}

}  // namespace

}  // namespace lucerna

int main(int argc, char** argv) {
    try {
        if (argc < 3) {
            throw std::runtime_error(
                "usage: photon_benchmark tracing|lookups|memory SCENE [number]");
        }
        lucerna::run(argv[1], argv[2], argc > 3 ? std::atoi(argv[3]) : 0);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
