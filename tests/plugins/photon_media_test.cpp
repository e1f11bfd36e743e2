// SPDX-License-Identifier: Apache-2.0
/// Photons in media: where they are scattered, the energy that media take, and the spheres that a
/// ray meets.
#include "core/math/warp.h"
#include "plugins/integrators/photon_beam.h"
#include "plugins/integrators/photon_storing.h"
#include "tests/plugins/workshop.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>

namespace lucerna {
namespace {

const Workers workers(7);
constexpr double radius = 2;

/// A lamp in the middle of a ball of fog, without anything else.
class PhotonsInMedia : public testing::Test {
protected:
    static std::string ball(double sigma_t, double albedo, const std::string& type) {
        return fmt::format(
            "<integrator type='photonmap'/><sensor type='perspective'/><emitter type='point'/>"
            "<shape type='sphere'><float name='radius' value='{}'/><bsdf type='null'/>"
            "<medium name='interior' type='{}'><float name='sigma_t' value='{}'/>"
            "<float name='albedo' value='{}'/><phase type='hg'><float name='g' value='0.5'/>"
            "</phase></medium></shape>",
            radius, type, sigma_t, albedo);
    }

    StoredPhotons trace(const std::string& xml, PhotonKinds kinds, const Workers& some = workers,
                        int max_depth = 100) {
        const PhotonTracer tracer(workshop_.make_scene(xml));
        StoredPhotons result;
        const PhotonPass pass{
            .key = 5, .count = 40000, .max_depth = max_depth, .kinds = kinds, .in_media = true};
        store_photons(
            tracer, pass, some, [] { return false; }, result);
        return result;
    }

    Workshop workshop_;
};

/// Power that shells around the lamp scatter first: albedo (exp(−σ a) − exp(−σ b)).
TEST_F(PhotonsInMedia, F1_O12_ShellsScatterWhatBeersLawSays) {
    constexpr double sigma = 0.7, albedo = 0.6, n = 40000;
    constexpr int shells = 4;
    for (const char* type : {"homogeneous", "heterogeneous"}) {
        SCOPED_TRACE(type);
        const StoredPhotons stored =
            trace(ball(sigma, albedo, type), static_cast<unsigned>(PhotonKind::direct));
        std::array<double, shells> power{};
        for (const Photon& photon : stored.in_media) {
            EXPECT_EQ(photon.depth(), 1);
            const double r = static_cast<double>(glm::length(photon.p()));
            power[static_cast<std::size_t>(std::min(r / radius * shells, shells - 0.5))] +=
                static_cast<double>(luminance(photon.power()));
        }
        for (int i = 0; i < shells; ++i) {
            const double a = radius * i / shells, b = radius * (i + 1) / shells;
            const double share = std::exp(-sigma * a) - std::exp(-sigma * b);
            EXPECT_NEAR(power[static_cast<std::size_t>(i)] / stored.energy.emitted, albedo * share,
                        4 * albedo * std::sqrt(share * (1 - share) / n));
        }
    }
}

/// A medium that only absorbs takes 1 − exp(−σ r): roulette takes whole photons, without bias.
TEST_F(PhotonsInMedia, F1_O12_AbsorptionIsBeersLaw) {
    const PhotonEnergy e = trace(ball(0.5, 0, "homogeneous"), all_kinds).energy;
    const double passed = std::exp(-0.5 * radius);
    EXPECT_EQ(e.stored, 0);
    EXPECT_NEAR(e.escaped / e.emitted, passed, 4 * std::sqrt(passed * (1 - passed) / 40000));
}

TEST_F(PhotonsInMedia, F1_F15_EnergyIsKept) {
    for (const double albedo : {0.0, 0.5, 1.0}) {
        for (const int depth : {1, 3, 100}) {
            const PhotonEnergy e =
                trace(ball(2, albedo, "homogeneous"), all_kinds, workers, depth).energy;
            EXPECT_NEAR(e.escaped + e.absorbed + e.cut, e.emitted, 1e-6 * e.emitted);
        }
    }
    // Whatever is scattered without absorption escapes in the end.
    const PhotonEnergy e = trace(ball(2, 1, "homogeneous"), all_kinds).energy;
    EXPECT_NEAR(e.escaped / e.emitted, 1, 1e-3);
}

TEST_F(PhotonsInMedia, SamePhotonsForAnyNumberOfThreads) {
    const auto places = [&](int threads) {
        std::vector<float> x;
        for (const Photon& photon :
             trace(ball(1, 0.8, "homogeneous"), all_kinds, Workers(threads)).in_media) {
            x.push_back(photon.p().x + photon.power().y);
        }
        return x;
    };
    const std::vector<float> one = places(1);
    EXPECT_GT(one.size(), 10000u);
    EXPECT_EQ(one, places(2));
    EXPECT_EQ(one, places(7));
}

/// Nothing is stored there unless it is asked for.
TEST_F(PhotonsInMedia, ScenesWithoutMediaHaveNone) {
    const StoredPhotons stored = trace(
        "<integrator type='photonmap'/><sensor type='perspective'/><emitter type='point'/>"
        "<shape type='sphere'/>",
        all_kinds);
    EXPECT_TRUE(stored.in_media.empty());
    EXPECT_FALSE(stored.photons.empty());
}

std::vector<Photon> cloud(std::size_t count) {
    Rng rng(1);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < count; ++i) {
        const Vector2 a = rng.next_float2();
        photons.push_back(Photon({a.x, a.y, rng.next_float()}, Color(1), {0, 0, 1}, {0, 0, 1}, 1));
    }
    return photons;
}

/// Distance² and radius² of what a ray meets, against all photons one by one.
TEST(BeamMap, FindsTheSpheresThatARayPierces) {
    constexpr int nearest = 10;
    const std::vector<Photon> photons = cloud(1003);
    std::vector<float> spread;  // squared distance of the tenth neighbour
    for (const Photon& photon : photons) {
        std::vector<float> all;
        for (const Photon& other : photons) {
            all.push_back(glm::dot(other.p() - photon.p(), other.p() - photon.p()));
        }
        std::nth_element(all.begin(), all.begin() + nearest, all.end());
        spread.push_back(std::min(all[nearest], 0.04f));
    }
    const BeamMap fixed(photons, 10, 0.1f, 0, workers),
        adapted(photons, 10, 0.2f, nearest, workers);
    Rng rng(2);
    for (int i = 0; i < 40; ++i) {
        const Vector2 a = rng.next_float2();
        const Vector3 o = i % 2 == 0 ? Vector3(a.x, a.y, -1) : Vector3(a.x, a.y, 0.5f);
        const Vector3 d = i < 8 ? Vector3(0, 0, 1) : square_to_uniform_sphere(rng.next_float2());
        const float length = i % 3 == 0 ? infinity : 1.3f;
        for (const BeamMap* map : {&fixed, &adapted}) {
            std::multiset<float> found, expected;
            map->search(o, d, length, [&](const Photon& photon, float, float distance2, float r2) {
                EXPECT_LT(distance2, r2);
                found.insert(photon.p().x);
            });
            for (std::size_t k = 0; k < photons.size(); ++k) {
                const Photon& photon = photons[k];
                const float t = glm::dot(photon.p() - o, d);
                const Vector3 off = photon.p() - o - t * d;
                const float r2 = map == &fixed ? sqr(0.1f) : spread[k];
                if (t >= 0 && t <= length && glm::dot(off, off) < r2) expected.insert(photon.p().x);
            }
            EXPECT_EQ(found, expected) << i;
        }
    }
    EXPECT_TRUE(BeamMap().empty());
    EXPECT_FLOAT_EQ(fixed.scale(), 0.1f);
}

TEST(PhotonParameters, WrongOnesOfMediaAreRefused) {
    const auto message = [](const std::string& parameter) {
        return refusal("<integrator type='photonmap'>" + parameter + "</integrator>");
    };
    EXPECT_EQ(message(whole("volume_lookup_size", 0)), "");
    EXPECT_NE(message(whole("volume_photons", 0)), "");
    EXPECT_NE(message(number("volume_lookup_radius", 0)), "");
    EXPECT_NE(message(whole("volume_lookup_size", 1024)), "");
}

}  // namespace
}  // namespace lucerna
