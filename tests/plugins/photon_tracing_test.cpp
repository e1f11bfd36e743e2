// SPDX-License-Identifier: Apache-2.0
/// Photons on their way: their numbers, the bookkeeping of energy, and who emits how many.
#include "plugins/integrators/photon_storing.h"
#include "tests/plugins/workshop.h"

#include <gtest/gtest.h>

#include <set>

namespace lucerna {
namespace {

const Workers workers(7);

/// Each coordinate of an aligned block of 2ᵏ photons has one value in each interval of 2⁻ᵏ, the
/// first two are a net, and what follows the first surface is independent.
TEST(PhotonNumbers, FillTheirDimensionsEvenly) {
    constexpr int n = 256, side = 16;
    for (const std::uint64_t first :
         {std::uint64_t{0}, 5 * std::uint64_t{n}, std::uint64_t{1} << 33}) {
        std::vector<std::set<int>> seen(8);
        std::set<int> cells;
        double product = 0;
        PhotonSequence sequence(7);
        for (std::uint64_t i = first; i < first + n; ++i) {
            PhotonNumbers numbers = sequence.photon(i);
            const Vector2 a = numbers.direction(), b = numbers.position();
            const auto c = numbers.scattering(true), later = numbers.scattering(false);
            const float all[] = {a.x,           a.y,           b.x,    b.y,
                                 c.direction.x, c.direction.y, c.lobe, c.survival};
            for (std::size_t d = 0; d < 8; ++d) {
                EXPECT_TRUE(0 <= all[d] && all[d] < 1);
                seen[d].insert(static_cast<int>(all[d] * n));
            }
            cells.insert(static_cast<int>(a.x * side) * side + static_cast<int>(a.y * side));
            product += (static_cast<double>(later.lobe) - 0.5) *
                       (static_cast<double>(later.direction.x) - 0.5);
        }
        for (const auto& values : seen) EXPECT_EQ(values.size(), std::size_t{n});
        EXPECT_EQ(cells.size(), std::size_t{n});
        EXPECT_LT(std::abs(product / n), 4.0 / 12 / std::sqrt(n));
    }
}

/// Photons in small scenes.
class PhotonTracing : public testing::Test {
protected:
    static constexpr const char* camera = "<integrator type='path'/><sensor type='perspective'/>";

    StoredPhotons trace(const std::string& xml, std::uint64_t count, PhotonKinds kinds = 7,
                        int max_depth = 100) {
        const Scene& scene = workshop_.make_scene(camera + xml);
        const PhotonTracer tracer(scene);
        StoredPhotons result;
        if (tracer.dark()) return result;
        const PhotonPass pass{.key = 5, .count = count, .max_depth = max_depth, .kinds = kinds};
        store_photons(
            tracer, pass, workers, [] { return false; }, result);
        return result;
    }

    static std::string room(double albedo, const std::string& more = "") {
        return "<shape type='cube'><boolean name='flip_normals' value='true'/><bsdf "
               "type='diffuse'>" +
               fmt::format("<float name='reflectance' value='{}'/></bsdf></shape>", albedo) + more;
    }
    static constexpr const char* lamp =
        "<emitter type='point'><float name='intensity' value='1'/></emitter>";

    Workshop workshop_;
};

TEST_F(PhotonTracing, F1_F15_EnergyIsKept) {
    const std::string glass =
        "<shape type='sphere'><transform name='to_world'><scale value='0.3'/><translate x='0.4'/>"
        "</transform><bsdf type='dielectric'/></shape>";
    const std::string open =
        "<shape type='rectangle'><transform name='to_world'><translate "
        "z='-1'/></transform></shape>";
    for (const std::string& xml : {room(0.5, glass), open + glass, room(0.9), room(0)}) {
        for (const int depth : {1, 2, 5, 100}) {
            const PhotonEnergy e = trace(xml + lamp, 20000, 7, depth).energy;
            EXPECT_NEAR(e.emitted, 4 * std::numbers::pi * 20000, 1e-5 * e.emitted);
            EXPECT_NEAR(e.escaped + e.absorbed + e.cut, e.emitted, 1e-6 * e.emitted);
        }
    }
    const PhotonEnergy black = trace(room(0) + lamp, 20000).energy;
    EXPECT_NEAR(black.stored, black.absorbed, 1e-9 * black.emitted);
    EXPECT_NEAR(black.stored, black.emitted, 1e-9 * black.emitted);
    // Each reflection keeps half: 1 + ½ + ¼ …
    const PhotonEnergy grey = trace(room(0.5) + lamp, 100000).energy;
    EXPECT_NEAR(grey.stored / grey.emitted, 2, 0.02);
    EXPECT_NEAR(grey.absorbed / grey.emitted, 1, 0.001);
}

TEST_F(PhotonTracing, RouletteKeepsThePowerOfPhotonsAlike) {
    for (const Photon& photon : trace(room(0.5) + lamp, 10000).photons) {
        EXPECT_NEAR(photon.power().x, 4 * pi, 1e-3f);
    }
}

TEST_F(PhotonTracing, F3_AllPhotonsEscape) {
    const StoredPhotons lost = trace(
        "<shape type='rectangle'><transform name='to_world'><translate "
        "z='-1e6'/></transform></shape><emitter type='directional'>"
        "<vector name='direction' value='0,0,1'/></emitter>",
        1000);
    EXPECT_EQ(lost.energy.emitted, lost.energy.escaped + lost.energy.absorbed);
    EXPECT_TRUE(trace(lamp, 1000).photons.empty());
}

TEST_F(PhotonTracing, NoLightsNoPhotons) {
    EXPECT_TRUE(trace(room(0.5), 1000).photons.empty());
    EXPECT_TRUE(trace(room(0.5,
                           "<emitter type='point'><float name='intensity' value='0'/>"
                           "</emitter>"),
                      1000)
                    .photons.empty());
}

TEST_F(PhotonTracing, LightsEmitInProportionToTheirPower) {
    const Scene& scene =
        workshop_.make_scene(std::string(camera) +
                             "<emitter type='point'><float name='intensity' value='1'/></emitter>"
                             "<emitter type='point'><float name='intensity' value='0'/></emitter>"
                             "<emitter type='point'><float name='intensity' value='3'/></emitter>");
    const PhotonEmission emission(scene);
    for (const std::uint64_t n : {1u, 10u, 1001u}) {
        for (const double offset : {0.0, 0.3, 0.999}) {
            std::vector<std::set<std::uint64_t>> indices(3);
            for (std::uint64_t j = 0; j < n; ++j) {
                const auto choice = emission.choose(j, n, offset);
                EXPECT_TRUE(indices[choice.light].insert(choice.index).second);
                EXPECT_NEAR(choice.pmf, choice.light == 0 ? 0.25 : 0.75, 1e-6);
            }
            EXPECT_TRUE(indices[1].empty());
            const double exact = 0.25 * static_cast<double>(n);
            EXPECT_LE(std::abs(static_cast<double>(indices[0].size()) - exact), 1);
            for (const auto& own : {indices[0], indices[2]}) {
                if (!own.empty()) {
                    EXPECT_EQ(*own.rbegin(), own.size() - 1);
                }
            }
        }
    }
}

TEST_F(PhotonTracing, KindsAreWhatTheySay) {
    const std::string mirror =
        "<shape type='rectangle'><transform name='to_world'><scale value='0.5'/><translate "
        "z='-0.9'/></transform><bsdf type='conductor'/></shape>";
    const std::string scene = room(0.5, mirror) + lamp;
    const auto count = [&](PhotonKind kind) {
        return trace(scene, 20000, static_cast<unsigned>(kind)).photons.size();
    };
    const std::size_t all = trace(scene, 20000).photons.size();
    EXPECT_EQ(count(PhotonKind::direct) + count(PhotonKind::caustic) + count(PhotonKind::indirect),
              all);
    EXPECT_GT(count(PhotonKind::caustic), 100u);
    for (const Photon& photon : trace(scene, 1000, 1).photons) EXPECT_EQ(photon.depth(), 1);
    for (const Photon& photon : trace(scene, 1000, 2).photons) {
        EXPECT_GT(photon.depth(), 1);
        EXPECT_GT(photon.p().z, -0.95f) << "the mirror shines upwards";
    }
    const std::string cut_out =
        "<shape type='rectangle'><bsdf type='mask'><bsdf type='diffuse'/></bsdf></shape>";
    EXPECT_FALSE(has_caustics(workshop_.make_scene(camera + room(0.5, cut_out)).shapes()));
    EXPECT_TRUE(has_caustics(workshop_.make_scene(camera + scene).shapes()));
    EXPECT_FALSE(has_caustics(workshop_.make_scene(camera + room(0.5)).shapes()));
}

TEST_F(PhotonTracing, SamePhotonsForAnyNumberOfThreads) {
    const auto places = [&](int threads) {
        const Workers some(threads);
        const PhotonTracer tracer(workshop_.make_scene(camera + room(0.7) + lamp));
        StoredPhotons result;
        store_photons(
            tracer, {.key = 1, .count = 10000, .max_depth = 10, .kinds = 7}, some,
            [] { return false; }, result);
        std::vector<float> x;
        for (const Photon& photon : result.photons) x.push_back(photon.p().x + photon.power().y);
        return x;
    };
    const std::vector<float> one = places(1);
    EXPECT_EQ(one, places(2));
    EXPECT_EQ(one, places(7));
}

TEST(PhotonParameters, F2_F4_WrongOnesAreRefused) {
    const auto message = [](const std::string& parameter, const std::string& type = "photonmap") {
        return refusal("<integrator type='" + type + "'>" + parameter + "</integrator>");
    };
    EXPECT_EQ(message(""), "");
    EXPECT_NE(message(whole("global_photons", 0)), "");
    EXPECT_NE(message(whole("caustic_photons", 0)), "");
    EXPECT_NE(message(number("global_lookup_radius", 0)), "");
    EXPECT_NE(message(whole("lookup_size", 1)), "");
    EXPECT_NE(message(whole("photon_count", 0), "sppm"), "");
    EXPECT_NE(message(number("alpha", 0), "sppm"), "");
    EXPECT_NE(message(whole("final_gather", 4) + word("direct_light", "photons")), "");
}

}  // namespace
}  // namespace lucerna
