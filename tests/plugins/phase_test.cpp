// SPDX-License-Identifier: Apache-2.0
/// What every phase function must satisfy, tried on all plugins that the registry finds, with
/// defaults and with parameters that are hard. A new plugin is tested unasked; only if it cannot be
/// made without a body does it need a line in `bodies`.
#include "core/interfaces/phase.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

#include <map>

namespace lucerna {
namespace {

const std::map<std::string, std::vector<std::string>>& bodies() {
    static const std::map<std::string, std::vector<std::string>> all = {
        {"hg", {"", number("g", 0), number("g", 1e-4), number("g", -0.9), number("g", 0.95)}},
        {"tabphase",
         {"", word("values", "0, 1"), word("values", "3, 0, 0, 1"), word("values", "1 2 0 7")}},
        {"blendphase",
         {number("weight", 0.3) + "<phase type='isotropic'/><phase type='hg'/>",
          number("weight", 0) + "<phase type='hg'/><phase type='rayleigh'/>",
          number("weight", 1) + "<phase type='rayleigh'/><phase type='hg'/>"}},
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
    const Vector3 p_{0.1f, 0.2f, 0.3f};
    const std::vector<Vector3> wos_ = {glm::normalize(Vector3(1, 2, -3)), {0, 0, 1}, {0, -1, 0}};

private:
    Workshop workshop_;
    const Phase* phase_ = nullptr;
};

INSTANTIATE_TEST_SUITE_P(All, EachPhase, testing::ValuesIn(tested_phases()),
                         [](const auto& p) { return p.param.type + std::to_string(p.index); });

TEST_P(EachPhase, D1_SamplesFollowTheDensity) {
    for (const Vector3 wo : wos_) {
        Rng rng(7);
        const auto sample = [&](Vector2 u) -> std::optional<Vector3> {
            return phase().sample(p_, wo, rng.next_float(), u).wi;
        };
        const auto pdf = [&](Vector3 wi) {
            return static_cast<double>(phase().evaluate(p_, wo, wi).pdf);
        };
        EXPECT_TRUE(sampling_matches_pdf(sample, pdf, {.grid = {.samples = 300000}, .tests = 40}));
    }
}

TEST_P(EachPhase, IntegralIsOne) {
    for (const Vector3 wo : wos_) {
        const auto f = [&](Vector3 wi) {
            return static_cast<double>(phase().evaluate(p_, wo, wi).f);
        };
        EXPECT_NEAR(integrate_sphere(f, 1e-5), 1, 1e-3);
    }
}

TEST_P(EachPhase, SampleSaysWhatEvaluateSays) {
    Rng rng(3);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 wo = wos_[static_cast<std::size_t>(i) % wos_.size()];
        const float u_lobe = rng.next_float();
        const PhaseSample s = phase().sample(p_, wo, u_lobe, rng.next_float2());
        const PhaseValue value = phase().evaluate(p_, wo, s.wi);
        EXPECT_NEAR(glm::length(s.wi), 1, 1e-5f);
        EXPECT_NEAR(s.pdf, value.pdf, 2e-3f * value.pdf + 1e-5f);
        EXPECT_NEAR(s.weight * s.pdf, value.f, 2e-3f * value.f + 1e-5f);
    }
}

TEST_P(EachPhase, IsReciprocal) {
    Rng rng(5);
    for (int i = 0; i < 100; ++i) {
        const Vector3 wo = wos_[static_cast<std::size_t>(i) % wos_.size()];
        const Vector3 wi = phase().sample(p_, wo, rng.next_float(), rng.next_float2()).wi;
        const float f = phase().evaluate(p_, wo, wi).f;
        EXPECT_NEAR(f, phase().evaluate(p_, wi, wo).f, 1e-5f * f);
    }
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

}  // namespace
}  // namespace lucerna
