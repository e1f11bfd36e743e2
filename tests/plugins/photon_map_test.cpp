// SPDX-License-Identifier: Apache-2.0
/// Photon records, both structures against brute force, kernels, and estimates of radiance.
#include "core/math/quadrature.h"
#include "core/math/warp.h"
#include "plugins/integrators/photon_estimate.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

#include <set>

namespace lucerna {
namespace {

const Workers workers(7);

Photon photon_at(Vector3 p, float power = 1, Vector3 n = {0, 0, 1}, Vector3 w = {0, 0, 1}) {
    return Photon(p, Color(power), w, n, 1);
}

/// Half on a floor, half in a ball: a mixture of two and three dimensions.
std::vector<Photon> cloud(std::size_t count, std::uint64_t seed = 1) {
    Rng rng(seed);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < count; ++i) {
        const Vector2 a = rng.next_float2();
        const float z = i % 2 == 0 ? 0.0f : rng.next_float();
        photons.push_back(photon_at({a.x, a.y, z}));
    }
    return photons;
}

using Places = std::multiset<std::array<float, 3>>;

Places found(const PhotonMap& map, Vector3 p, float radius) {
    Places result;
    float radius2 = sqr(radius);
    map.search(p, radius2, [&](const Photon& photon, float d2) {
        EXPECT_LT(d2, sqr(radius));
        const Vector3 q = photon.p();
        result.insert({q.x, q.y, q.z});
    });
    return result;
}

Places found_by_force(const std::vector<Photon>& photons, Vector3 p, float radius) {
    Places result;
    for (const Photon& photon : photons) {
        const Vector3 v = photon.p() - p;
        if (glm::dot(v, v) < sqr(radius)) result.insert({v.x + p.x, v.y + p.y, v.z + p.z});
    }
    return result;
}

TEST(Photon, KeepsWhatItIsGiven) {
    Rng rng(1);
    for (int i = 0; i < 10000; ++i) {
        const Vector3 w = square_to_uniform_sphere(rng.next_float2());
        const Vector3 n = square_to_uniform_sphere(rng.next_float2());
        const Photon photon({1, 2, 3}, {4, 5, 6}, w, n, i % 256);
        EXPECT_LT(glm::length(photon.direction() - w), 0x1p-13f);
        EXPECT_LT(glm::length(photon.normal() - n), 0x1p-9f);
        EXPECT_EQ(photon.depth(), i % 256);
    }
    EXPECT_EQ(Photon({}, {}, {0, 0, 1}, {0, 0, 1}, 1000).depth(), 255);
}

TEST(Photon, AxesAreExact) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0f, 1.0f}) {
            Vector3 w(0);
            w[axis] = sign;
            EXPECT_EQ(decode_direction(encode_direction(w, 16), 16), w);
            EXPECT_EQ(decode_direction(encode_direction(w, 12), 12), w);
        }
    }
}

/// Every coordinate is shared by many: they lie on the planes that split the tree, on the faces of
/// cells, and on edges and corners of a cube.
std::vector<Photon> lattice() {
    std::vector<Photon> photons;
    for (int i = 0; i < 8 * 8 * 8; ++i) {
        const Vector3 p(static_cast<float>(i % 8), static_cast<float>(i / 8 % 8),
                        static_cast<float>(i / 64));
        photons.push_back(photon_at(0.125f * p));
    }
    return photons;
}

TEST(PhotonMap, FindsWhatBruteForceFinds) {
    std::vector<std::vector<Photon>> sets = {lattice()};
    for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 100u, 5000u}) sets.push_back(cloud(count));
    for (const std::vector<Photon>& photons : sets) {
        const std::size_t count = photons.size();
        for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
            for (const float radius : {0.01f, 0.1f, 3.0f}) {
                const PhotonMap map(photons, 1, structure, radius, workers);
                Rng rng(2);
                for (int i = 0; i < 20; ++i) {
                    const Vector2 a = rng.next_float2();
                    const Vector3 p(a.x, a.y, 0.2f * rng.next_float());
                    EXPECT_EQ(found(map, p, radius).size(),
                              found_by_force(photons, p, radius).size());
                    // On a photon, and so on planes that split.
                    if (count == 0) continue;
                    const Vector3 q = photons[static_cast<std::size_t>(i) % count].p();
                    EXPECT_EQ(found(map, q, radius).size(),
                              found_by_force(photons, q, radius).size());
                }
            }
        }
    }
}

TEST(PhotonMap, NearestAreTheNearest) {
    const std::vector<Photon> photons = cloud(3000);
    for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
        const PhotonMap map(photons, 1, structure, 2, workers);
        for (const int k : {1, 2, 3, 10, 64, 1024}) {
            const Vector3 p(0.4f, 0.6f, 0.1f);
            NearestPhotons nearest(k);
            float radius2 = 4;
            map.search(p, radius2, [&](const Photon& photon, float d2) {
                nearest.add({d2, &photon});
                if (nearest.full()) radius2 = nearest.farthest2();
            });
            std::vector<float> all, got;
            for (const Photon& photon : photons) {
                all.push_back(glm::dot(photon.p() - p, photon.p() - p));
            }
            for (const auto& f : nearest.all()) got.push_back(f.distance2);
            std::sort(all.begin(), all.end());
            std::sort(got.begin(), got.end());
            all.resize(got.size());
            EXPECT_EQ(static_cast<int>(got.size()), k);
            EXPECT_EQ(got, all) << k;
        }
    }
}

TEST(PhotonMap, OrderIsThatOfOneThread) {
    const auto order = [](int threads, PhotonStructure structure) {
        const Workers some(threads);
        const PhotonMap map(cloud(20000), 1, structure, 0.01f, some);
        std::vector<float> x;
        for (const Photon& photon : map.photons()) x.push_back(photon.p().x);
        return x;
    };
    for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
        EXPECT_EQ(order(1, structure), order(2, structure));
        EXPECT_EQ(order(1, structure), order(7, structure));
    }
}

TEST(PhotonMap, TenMillionNeedLessThan400Megabytes) {
    const std::size_t count = 1 << 16;
    const PhotonMap tree(cloud(count), 1, PhotonStructure::kdtree, 1, workers);
    EXPECT_LE(static_cast<double>(tree.bytes()) / static_cast<double>(count), 33.01);
}

TEST(PhotonMap, AMillionPhotonsAtOnePoint) {
    const std::vector<Photon> photons(1000000, photon_at({1, 2, 3}));
    for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
        const PhotonMap map(photons, 1, structure, 0.1f, workers);
        EXPECT_EQ(found(map, {1, 2, 3}, 0.01f).size(), photons.size());
        EXPECT_EQ(found(map, {1, 2, 4}, 0.1f).size(), 0u);
    }
}

TEST(PhotonMap, F17_TinyRadiusInAHugeScene) {
    std::vector<Photon> photons;
    for (const float x : {-1e12f, 0.0f, 1e12f}) photons.push_back(photon_at({x, x, x}));
    const PhotonMap map(photons, 1, PhotonStructure::grid, 1e-12f, workers);
    EXPECT_EQ(found(map, {0, 0, 0}, 1e-12f).size(), 1u);
    EXPECT_EQ(found(map, {1e12f, 1e12f, 1e12f}, 1e-12f).size(), 1u);
}

TEST(PhotonKernel, IntegratesToOne) {
    for (const auto filter : {PhotonFilter::none, PhotonFilter::cone, PhotonFilter::gaussian}) {
        double sum = 0;
        const int n = 100000;
        for (int i = 0; i < n; ++i) {
            const double t = (i + 0.5) / n;
            sum += static_cast<double>(photon_kernel(filter, static_cast<float>(t * t))) * 2 *
                   std::numbers::pi * t / n;
        }
        EXPECT_NEAR(sum, 1, 1e-5);
        EXPECT_GE(photon_kernel(filter, 1), 0);
    }
}

/// A point on a white diffuse floor, seen from above, and photons around it.
class PhotonEstimate : public testing::Test {
protected:
    PhotonEstimate() : bsdf_(workshop_.make<BSDF>("<bsdf type='diffuse'/>")) {}

    /// What the estimate is for the irradiance one, from `count` photons on a square of area 1.
    RunningStatistics on_uniform_floor(PhotonLookup lookup, PhotonStructure structure,
                                       float radius) {
        RunningStatistics result;
        const int count = 10000;
        for (std::uint64_t seed = 0; seed < 100; ++seed) {
            Rng rng(seed);
            std::vector<Photon> photons;
            for (int i = 0; i < count; ++i) {
                const Vector2 a = rng.next_float2();
                photons.push_back(photon_at({a.x, a.y, 0}));
            }
            const PhotonMap map(std::move(photons), count, structure, radius, workers);
            for (int i = 0; i < 20; ++i) {
                const Vector2 a = 0.2f + 0.6f * rng.next_float2();
                result.add(seen(map, lookup, {a.x, a.y, 0}) * 2 * std::numbers::pi);
            }
        }
        return result;
    }

    double seen(const PhotonMap& map, PhotonLookup lookup, Vector3 p, Vector3 n = {0, 0, 1}) {
        Interaction at;
        at.p = p;
        at.n = n;
        at.shading = Frame::from_normal(n);
        lookup.max_depth = 100;
        return static_cast<double>(photon_radiance(map, lookup, bsdf_, at, n).x);
    }

    Workshop workshop_;
    const BSDF& bsdf_;
};

TEST_F(PhotonEstimate, F6_O19_UniformIrradiance) {
    for (const auto filter : {PhotonFilter::none, PhotonFilter::cone, PhotonFilter::gaussian}) {
        for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
            SCOPED_TRACE(static_cast<int>(filter));
            EXPECT_TRUE(
                equivalent(on_uniform_floor({.filter = filter}, structure, 0.05f), 1, 0.02));
            EXPECT_TRUE(equivalent(
                on_uniform_floor({.count = 10, .filter = filter}, structure, 0.2f), 1, 0.05));
        }
    }
}

TEST_F(PhotonEstimate, F7_EdgesAndCornersAreDarker) {
    std::vector<Photon> photons;
    const int side = 400;
    for (int i = 0; i < side * side; ++i) {
        photons.push_back(photon_at({(static_cast<float>(i % side) + 0.5f) / side,
                                     (static_cast<float>(i / side) + 0.5f) / side, 0}));
    }
    const PhotonMap map(photons, side * side, PhotonStructure::kdtree, 0.1f, workers);
    // At a distance of t radii from an edge a segment of the disk is empty.
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const double missing = (std::acos(t) - t * std::sqrt(1 - t * t)) / std::numbers::pi;
        const Vector3 p(static_cast<float>(0.1 * t), 0.5f, 0);
        EXPECT_NEAR(seen(map, {.filter = PhotonFilter::none}, p) * 2 * std::numbers::pi,
                    1 - missing, 0.01);
    }
    EXPECT_NEAR(seen(map, {.filter = PhotonFilter::none}, {0, 0, 0}) * 2 * std::numbers::pi, 0.25,
                0.01);
}

TEST_F(PhotonEstimate, F8_F9_F10_NothingLeaksThroughWallsOrAroundCorners) {
    const Vector3 up(0, 0, 1), down(0, 0, -1), east(1, 0, 0);
    const float thin = 1e-3f;  // of a radius
    const std::vector<Photon> below(1000, photon_at({0, 0, -thin}, 1, down, down));
    const std::vector<Photon> corner(1000, photon_at({0, 0, 0.01f}, 1, east, east));
    const std::vector<Photon> shelf(1000, photon_at({0, 0, -0.5f}, 1, up, up));
    for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
        for (const int count : {0, 50}) {
            for (const auto& photons : {below, corner, shelf}) {
                const PhotonMap map(photons, 1000, structure, 1, workers);
                EXPECT_EQ(seen(map, {.count = count}, {0, 0, 0}), 0);
            }
        }
    }
    // Photons of the back do not shrink the radius of the front.
    std::vector<Photon> both = below;
    for (int i = 0; i < 100; ++i) {
        both.push_back(photon_at({0.01f * static_cast<float>(i), 0, 0}));
    }
    const PhotonMap map(both, 1100, PhotonStructure::kdtree, 1, workers);
    EXPECT_NEAR(seen(map, {.count = 51, .filter = PhotonFilter::none}, {0, 0, 0}),
                50 / (0.5 * 0.5 * 2 * sqr(std::numbers::pi) * 1100), 1e-4);
}

TEST_F(PhotonEstimate, FiniteInExtremes) {
    const std::vector<Photon> many(5000, photon_at({0, 0, 0}));
    for (const auto structure : {PhotonStructure::kdtree, PhotonStructure::grid}) {
        for (const int count : {0, 2, 50}) {
            SCOPED_TRACE(count);
            const PhotonMap none({}, 0, structure, 1, workers);
            EXPECT_EQ(seen(none, {.count = count}, {0, 0, 0}), 0);
            const PhotonMap one({photon_at({0.1f, 0, 0})}, 1, structure, 1, workers);
            EXPECT_GT(seen(one, {.count = count}, {0, 0, 0}), 0);
            EXPECT_TRUE(std::isfinite(seen(one, {.count = count}, {0.1f, 0, 0})));
            const PhotonMap huge({photon_at({0.1f, 0, 0})}, 1, structure, 1e6f, workers);
            EXPECT_TRUE(std::isfinite(seen(huge, {.count = count}, {0, 0, 0})));
            const PhotonMap coincident(many, 5000, structure, 1, workers);
            EXPECT_TRUE(std::isfinite(seen(coincident, {.count = count}, {0, 0, 0})));
        }
    }
}

}  // namespace
}  // namespace lucerna
