// SPDX-License-Identifier: Apache-2.0
/// What every phase function must satisfy, tried on all plugins that the registry finds, with
/// defaults and with parameters that are hard. A new plugin is tested unasked; only if it cannot be
/// made without a body does it need a line in `bodies`.
#include "core/interfaces/phase.h"
#include "core/math/warp.h"
#include "plugins/commands/contracts/phase.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"
#include "tests/vol_writer.h"

#include <map>

namespace lucerna {
namespace {

/// Eigenvalues 0.13, 0.70 and 1.12.
constexpr const char* turned_flakes = "0.15, 1, 0.8, 0.05, 0.1, -0.2";

const std::map<std::string, std::vector<std::string>>& bodies() {
    static const std::map<std::string, std::vector<std::string>> all = {
        {"hg", {"", number("g", 0), number("g", 1e-4), number("g", -0.9), number("g", 0.95)}},
        {"tabphase",
         {"", word("values", "0, 1"), word("values", "3, 0, 0, 1"), word("values", "1 2 0 7")}},
        // Thin flakes, fibres, and what is turned against the axes.
        {"sggx",
         {"", word("S", "1e-3, 1e-3, 1, 0, 0, 0"), word("S", "1, 0.7, 0.01, 0, 0, 0"),
          word("S", turned_flakes)}},
        {"blendphase",
         {number("weight", 0.3) + "<phase type='isotropic'/><phase type='hg'/>",
          number("weight", 0) + "<phase type='hg'/><phase type='rayleigh'/>",
          number("weight", 1) + "<phase type='rayleigh'/><phase type='hg'/>",
          number("weight", 0.3) + "<phase type='hg'/><phase type='sggx'>" +
              word("S", turned_flakes) + "</phase>"}},
    };
    return all;
}

struct TestedPhase {
    std::string type, body;
};
std::vector<TestedPhase> tested_phases() {
    std::vector<TestedPhase> result;
    for (const std::string& type : Registry().names(Phase::kind)) {
        const auto found = bodies().find(type);
        const std::vector<std::string> none{""};
        for (const std::string& body : found == bodies().end() ? none : found->second) {
            result.push_back({type, body});
        }
    }
    return result;
}

class EachPhase : public testing::TestWithParam<TestedPhase> {
protected:
    const Phase& phase() {
        if (!phase_) {
            phase_ = &workshop_.make<Phase>("<phase type='" + GetParam().type + "'>" +
                                            GetParam().body + "</phase>");
        }
        return *phase_;
    }

    static testing::AssertionResult kept(const Evidence& evidence) {
        return holds(evidence, sidak(0.01, 3.0 * 20));
    }
    const Effort effort_{.samples = 300000};

private:
    Workshop workshop_;
    const Phase* phase_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(All, EachPhase, testing::ValuesIn(tested_phases()),
                         [](const auto& p) { return p.param.type + std::to_string(p.index); });

TEST_P(EachPhase, D1_SamplesFollowTheDensity) {
    for (const Evidence& evidence : contracts::phase_density(phase(), effort_)) {
        EXPECT_TRUE(kept(evidence));
    }
}

TEST_P(EachPhase, IntegralIsOne) { EXPECT_TRUE(kept(contracts::phase_integral(phase(), effort_))); }

TEST_P(EachPhase, SampleSaysWhatEvaluateSays) {
    EXPECT_TRUE(kept(contracts::phase_samples(phase(), effort_)));
    EXPECT_TRUE(kept(contracts::phase_support(phase(), effort_)));
    EXPECT_TRUE(kept(contracts::phase_extreme_numbers(phase())));
}

TEST_P(EachPhase, IsReciprocal) {
    EXPECT_TRUE(kept(contracts::phase_reciprocity(phase(), effort_)));
}

TEST_P(EachPhase, G15_ProjectedAreasAreBoundedAndTheSameBothWays) {
    EXPECT_TRUE(kept(contracts::phase_areas(phase(), effort_)));
}

TEST_P(EachPhase, G15_BoundsOfProjectedAreasAreTight) {
    const Vector3 p(0.1f, 0.2f, 0.3f);
    Rng rng(6);
    float largest = 0;
    for (int i = 0; i < 10000; ++i) {
        const Vector3 w = square_to_uniform_sphere(rng.next_float2());
        largest = std::max(largest, phase().projected_area(p, w));
    }
    EXPECT_GT(largest, 0.9f * phase().max_projected_area({.min = p - 0.1f, .max = p + 0.1f}));
}

/// The mean cosine is g, also where the density is a needle.
TEST(HenyeyGreenstein, D16_MeanCosineIsG) {
    for (const double g : {-0.999, -0.5, 0.0, 0.3, 0.9, 0.999}) {
        Workshop workshop;
        const auto& phase = workshop.make<Phase>("<phase type='hg'>" + number("g", g) + "</phase>");
        const Vector3 wo = glm::normalize(Vector3(1, -2, 0.5f));
        Rng rng(11);
        RunningStatistics cosines;
        for (int i = 0; i < 200000; ++i) {
            const PhaseSample s = phase.sample({}, wo, 0, rng.next_float2());
            cosines.add(static_cast<double>(-glm::dot(wo, s.wi)));
            EXPECT_TRUE(s.pdf > 0 && std::isfinite(s.pdf));
        }
        EXPECT_TRUE(mean_matches(cosines, g)) << g;
    }
}

TEST(TabulatedPhase, StandsForTheCosineFromBackwardsToForwards) {
    Workshop workshop;
    const auto& phase =
        workshop.make<Phase>("<phase type='tabphase'>" + word("values", "0, 0.1, 1") + "</phase>");
    // ∫ over the cosine: (0 + 0.1) / 2 + (0.1 + 1) / 2 = 0.6.
    const Vector3 wo(0, 0, 1);
    EXPECT_NEAR(phase.evaluate({}, wo, -wo).f, 1 / 0.6 / (2 * std::numbers::pi), 1e-6);
    EXPECT_NEAR(phase.evaluate({}, wo, wo).f, 0, 1e-6);
    EXPECT_NEAR(phase.evaluate({}, wo, {1, 0, 0}).f, 0.1 / 0.6 / (2 * std::numbers::pi), 1e-6);
}

class Sggx : public testing::Test {
protected:
    const Phase& make(const std::string& s) {
        return workshop_.make<Phase>("<phase type='sggx'>" + word("S", s) + "</phase>");
    }
    /// Of normals, from light that goes back as it came: D(m) = 4 σ(m) f(m, m).
    static double normal_density(const Phase& phase, Vector3 m) {
        return static_cast<double>(4 * phase.projected_area({}, m) * phase.evaluate({}, m, m).f);
    }
    Workshop workshop_;
};

TEST_F(Sggx, G15_ProjectedAreaIsThatOfAllNormals) {
    for (const char* s : {turned_flakes, "1, 0.7, 0.05, 0, 0, 0", "4, 9, 1, 2, 0.3, -0.5"}) {
        const Phase& phase = make(s);
        for (const Vector3 w : {Vector3(0, 0, 1), glm::normalize(Vector3(1, 2, -3))}) {
            const double seen = integrate_sphere(
                [&](Vector3 m) {
                    return static_cast<double>(std::max(glm::dot(w, m), 0.0f)) *
                           normal_density(phase, m);
                },
                1e-5);
            const double area = static_cast<double>(phase.projected_area({}, w));
            EXPECT_NEAR(seen, area, 1e-3 * area) << s;
        }
    }
}

/// A sphere of flakes scatters into all directions alike.
TEST_F(Sggx, FlakesWithoutADirectionAreIsotropic) {
    const Phase& phase = make("0.25, 0.25, 0.25, 0, 0, 0");
    Rng rng(8);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 wo = square_to_uniform_sphere(rng.next_float2());
        const Vector3 wi = square_to_uniform_sphere(rng.next_float2());
        EXPECT_NEAR(phase.evaluate({}, wo, wi).f, inv_pi / 4, 1e-6f);
        EXPECT_NEAR(phase.projected_area({}, wo), 0.5f, 1e-6f);
    }
    // Light that goes on as it came has no half vector.
    EXPECT_NEAR(phase.evaluate({}, {0, 0, 1}, {0, 0, -1}).f, inv_pi / 4, 1e-6f);
}

TEST_F(Sggx, HasTheValuesOfMitsuba) {
    const Phase& phase = make(turned_flakes);
    const struct {
        Vector3 wo, wi;
        float area, f;  // Mitsuba 3.9.1, scalar_rgb
    } values[] = {
        {{0, 0, 1}, {0, 0, 1}, 0.8944272f, 0.1293186f},
        {glm::normalize(Vector3(1, 2, -3)), {0, -1, 0}, 0.9765099f, 0.03275171f},
        {{0.6f, 0, 0.8f}, glm::normalize(Vector3(-2, 1, 1)), 0.8136339f, 0.0625966f},
        {{1, 0, 0}, {0, 1, 0}, 0.3872983f, 0.04620424f},
    };
    for (const auto& v : values) {
        EXPECT_NEAR(phase.projected_area({}, v.wo), v.area, 1e-6f);
        EXPECT_NEAR(phase.evaluate({}, v.wo, v.wi).f, v.f, 1e-6f);
    }
}

/// Voxels that are empty have no flakes, and matrices between voxels are interpolated.
TEST_F(Sggx, G15_MatricesOfAGrid) {
    const TemporaryFolder folder;
    write_bytes(folder / "s.vol", vol_bytes({.resolution = {2, 1, 1}, .channels = 6},
                                            std::vector<float>{0, 0, 0, 0, 0, 0,  //
                                                               0.2f, 1, 0.8f, 0.1f, -0.1f, 0.2f}));
    Workshop workshop(folder.path());
    const auto& phase =
        workshop.make<Phase>("<phase type='sggx'><volume type='gridvolume' name='S'>" +
                             word("filename", "s.vol") + "</volume></phase>");
    const Vector3 x(1, 0, 0), empty(0.1f, 0.5f, 0.5f), full(0.9f, 0.5f, 0.5f);
    EXPECT_FALSE(phase.uniform());
    EXPECT_NEAR(phase.projected_area(full, x), std::sqrt(0.2f), 1e-6f);
    EXPECT_NEAR(phase.projected_area({0.5f, 0.5f, 0.5f}, x), std::sqrt(0.1f), 1e-6f);
    EXPECT_EQ(phase.projected_area(empty, x), 0);
    EXPECT_TRUE(std::isfinite(phase.evaluate(empty, x, {0, 1, 0}).f));
    EXPECT_TRUE(std::isfinite(phase.sample(empty, x, 0, {0.3f, 0.6f}).pdf));
    // Beyond its ends, the last voxel goes on: bounds hold there, too.
    const Bounds3 beyond{.min = Vector3(2), .max = Vector3(3)};
    EXPECT_GE(phase.max_projected_area(beyond),
              phase.projected_area({2.5f, 2.5f, 2.5f}, {0, 1, 0}));
    EXPECT_EQ(phase.max_projected_area({.min = Vector3(0), .max = {0.2f, 1, 1}}), 0);
}

}  // namespace
}  // namespace lucerna
