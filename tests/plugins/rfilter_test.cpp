// SPDX-License-Identifier: Apache-2.0
/// What every reconstruction filter must satisfy, tried on all that the registry finds.
#include "core/interfaces/rfilter.h"
#include "core/render/filter_sampler.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

namespace lucerna {
namespace {

std::string rfilter(const std::string& type, const std::string& body = "") {
    return fmt::format("<rfilter type='{}'>{}</rfilter>", type, body);
}

/// ∫ f over its support, by the midpoint rule.
double integral(const RFilter& f) {
    constexpr int n = 200000;
    const double r = static_cast<double>(f.radius());
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        sum += static_cast<double>(f.evaluate(static_cast<float>((2 * (i + 0.5) / n - 1) * r)));
    }
    return sum * 2 * r / n;
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
    for (const auto& [name, f] : filters_) {
        SCOPED_TRACE(name);
        const float r = f->radius();
        EXPECT_GT(r, 0);
        for (int i = 0; i <= 1000; ++i) {
            const float x = r * static_cast<float>(i) / 1000;
            EXPECT_TRUE(std::isfinite(f->evaluate(x)));
            EXPECT_EQ(f->evaluate(x), f->evaluate(-x));
            EXPECT_LE(f->evaluate(x), f->evaluate(0));
        }
        for (const float x : {1.0001f, 1.5f, 100.0f}) EXPECT_EQ(f->evaluate(x * r), 0);
    }
}

/// Samples lie where |f| says, and are negative where f is. In x and in y alike.
TEST_F(RFilters, SamplesAreDistributedAsTheFilter) {
    constexpr std::size_t cells = 48;
    constexpr int samples = 200000;
    const double level = sidak(0.01, 2.0 * static_cast<double>(filters_.size()));
    for (const auto& [name, f] : filters_) {
        SCOPED_TRACE(name);
        const FilterSampler sampler(*f);
        const float r = f->radius();
        std::vector<double> observed[2] = {std::vector<double>(cells), std::vector<double>(cells)};
        Rng rng(11);
        for (int i = 0; i < samples; ++i) {
            const FilterSampler::Sample sample = sampler.sample(rng.next_float2());
            for (int axis = 0; axis < 2; ++axis) {
                const float x = (sample.offset[axis] / r + 1) / 2;
                ASSERT_TRUE(x >= 0 && x <= 1);
                const auto cell = static_cast<std::size_t>(x * cells);
                observed[axis][std::min(cell, cells - 1)] += 1;
            }
            const float value = f->evaluate(sample.offset.x) * f->evaluate(sample.offset.y);
            if (std::abs(value) > 1e-3f * sqr(f->evaluate(0))) {
                ASSERT_EQ(value < 0, sample.negative);
            }
        }
        std::vector<double> expected(cells);
        constexpr std::size_t steps = 2000;  // in each cell
        for (std::size_t i = 0; i < cells * steps; ++i) {
            const double x = (2 * (static_cast<double>(i) + 0.5) / (cells * steps) - 1) * r;
            expected[i / steps] += std::abs(double(f->evaluate(static_cast<float>(x))));
        }
        double total = 0;
        for (const double e : expected) total += e;
        for (double& e : expected) e *= samples / total;
        EXPECT_TRUE(counts_match(observed[0], expected, level));
        EXPECT_TRUE(counts_match(observed[1], expected, level));
    }
}

TEST_F(RFilters, H1_HaveAPositiveIntegral) {
    for (const auto& [name, f] : filters_) {
        SCOPED_TRACE(name);
        EXPECT_GT(integral(*f), 0);
        const FilterSampler sampler(*f);
        EXPECT_GE(sampler.negative_weight(), 0);
        EXPECT_LT(sampler.negative_weight(), 2);
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
    const auto of = [&](const std::string& xml) { return integral(workshop_.make<RFilter>(xml)); };
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
