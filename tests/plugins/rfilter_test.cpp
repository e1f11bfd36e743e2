// SPDX-License-Identifier: Apache-2.0
/// What every reconstruction filter must satisfy, tried on all that the registry finds.
#include "core/interfaces/rfilter.h"
#include "plugins/commands/contracts/rfilter.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

namespace lucerna {
namespace {

std::string rfilter(const std::string& type, const std::string& body = "") {
    return fmt::format("<rfilter type='{}'>{}</rfilter>", type, body);
}

class RFilters : public testing::Test {
protected:
    void SetUp() override {
        for (const std::string& name : workshop_.registry().names("rfilter")) {
            filters_.emplace_back(name, &workshop_.make<RFilter>(rfilter(name)));
        }
        filters_.emplace_back("wide tent",
                              &workshop_.make<RFilter>(rfilter("tent", number("radius", 3.5))));
        filters_.emplace_back("wide gaussian",
                              &workshop_.make<RFilter>(rfilter("gaussian", number("stddev", 2))));
        filters_.emplace_back("spline", &workshop_.make<RFilter>(
                                            rfilter("mitchell", number("B", 1) + number("C", 0))));
        filters_.emplace_back("sharp lanczos",
                              &workshop_.make<RFilter>(rfilter("lanczos", whole("lobes", 8))));
    }

    Workshop workshop_;
    std::vector<std::pair<std::string, const RFilter*>> filters_;
};

TEST_F(RFilters, AreSymmetricAndEndAtTheirRadius) {
    EXPECT_GE(filters_.size(), 10u);
    for (const auto& [name, f] : filters_) EXPECT_TRUE(holds(contracts::rfilter_shape(*f))) << name;
}

TEST_F(RFilters, WeightsOfPixelsAreTheFilter) {
    for (const auto& [name, f] : filters_) {
        EXPECT_TRUE(holds(contracts::rfilter_weights(*f))) << name;
    }
}

TEST_F(RFilters, H1_HaveAPositiveIntegral) {
    for (const auto& [name, f] : filters_) {
        EXPECT_TRUE(holds(contracts::rfilter_integral(*f))) << name;
    }
}

TEST_F(RFilters, AreContinuousButForTheBox) {
    for (const auto& [name, f] : filters_) {
        if (name == "box") continue;
        SCOPED_TRACE(name);
        float last = 0;
        for (int i = -10001; i <= 10001; ++i) {
            const float value = f->evaluate(f->radius() * static_cast<float>(i) / 10000);
            EXPECT_NEAR(value, last, 2e-3f * f->radius());
            last = value;
        }
    }
}

TEST_F(RFilters, HaveTheIntegralsOfTheirFormulas) {
    const auto of = [&](const std::string& xml) {
        return contracts::integral(workshop_.make<RFilter>(xml));
    };
    EXPECT_NEAR(of(rfilter("box")), 1, 1e-4);
    EXPECT_NEAR(of(rfilter("tent")), 1, 1e-6);
    EXPECT_NEAR(of(rfilter("tent", number("radius", 2))), 2, 1e-5);
    EXPECT_NEAR(of(rfilter("catmullrom")), 1, 1e-6);
    EXPECT_NEAR(of(rfilter("lanczos")), 0.997055, 1e-5);
    for (const double b : {0.0, 1.0 / 3, 1.0}) {
        EXPECT_NEAR(of(rfilter("mitchell", number("B", b) + number("C", 0.25))), 1, 1e-6);
    }
    const double sigma = 0.5;
    const double whole_bell = sigma * std::sqrt(2 * std::numbers::pi) * (2 * normal_cdf(4) - 1);
    EXPECT_NEAR(of(rfilter("gaussian")), whole_bell - 8 * sigma * std::exp(-8.0), 1e-6);
}

TEST_F(RFilters, CubicsAddUpToOneOverThePixels) {
    for (const char* name : {"mitchell", "catmullrom", "tent"}) {
        const RFilter& f = workshop_.make<RFilter>(rfilter(name));
        for (float x = 0; x < 1; x += 0.01f) {
            float sum = 0;
            for (int i = -2; i <= 2; ++i) sum += f.evaluate(x + static_cast<float>(i));
            EXPECT_NEAR(sum, 1, 1e-6f) << name << " at " << x;
        }
    }
}

TEST(RFilter, WrongParametersAreRefused) {
    EXPECT_NE(refusal(rfilter("box", number("radius", 0))), "");
    EXPECT_NE(refusal(rfilter("tent", number("radius", -1))), "");
    EXPECT_NE(refusal(rfilter("gaussian", number("stddev", 0))), "");
    EXPECT_NE(refusal(rfilter("lanczos", whole("lobes", 0))), "");
    EXPECT_NE(refusal(rfilter("mitchell", number("A", 0))), "");
}

}  // namespace
}  // namespace lucerna
