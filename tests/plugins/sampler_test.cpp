// SPDX-License-Identifier: Apache-2.0
/// What every sampler must satisfy, tried on all that the registry finds.
#include "core/interfaces/sampler.h"
#include "plugins/commands/contracts/sampler.h"
#include "plugins/samplers/seeded.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

#include <map>
#include <set>

namespace lucerna {
namespace {

constexpr int sample_count = 64;  // a square and a power of two

/// A sample count that the sampler does not change: `orthogonal` wants the square of a prime.
int exact_count(const std::string& name) { return name == "orthogonal" ? 49 : sample_count; }

std::string sampler(const std::string& type, const std::string& body) {
    return fmt::format("<sampler type='{}'>{}</sampler>", type, body);
}

class Samplers : public testing::Test {
protected:
    void SetUp() override {
        for (const std::string& name : workshop_.registry().names("sampler")) {
            samplers_.emplace_back(name, &make(name, exact_count(name)));
        }
    }

    const Sampler& make(const std::string& name, int samples = sample_count, int seed = 0) {
        return workshop_.make<Sampler>(
            sampler(name, whole("sample_count", samples) + whole("seed", seed)));
    }

    Workshop workshop_;
    std::vector<std::pair<std::string, const Sampler*>> samplers_;
};

TEST_F(Samplers, J1_J2_J5_J7_NumbersLieInTheHalfOpenInterval) {
    EXPECT_GE(samplers_.size(), 5u);
    for (const auto& [name, s] : samplers_) {
        EXPECT_EQ(s->sample_count(), exact_count(name));
        EXPECT_TRUE(holds(contracts::sampler_range(*s))) << name;
    }
}

TEST_F(Samplers, J7_AnIndexAboveTheLargestIntegerIsAnotherSample) {
    for (const auto& [name, s] : samplers_) {
        EXPECT_TRUE(holds(contracts::sampler_large_indices(*s))) << name;
    }
}

TEST_F(Samplers, ArePureFunctions) {
    for (const auto& [name, s] : samplers_) {
        const Sampler& again = make(name, exact_count(name));
        EXPECT_TRUE(holds(contracts::sampler_purity(*s, again, {}))) << name;
    }
}

TEST_F(Samplers, BlocksHoldThePairsAndStreamsMayJump) {
    for (const auto& [name, s] : samplers_) {
        EXPECT_TRUE(holds(contracts::sampler_blocks(*s))) << name;
    }
}

TEST_F(Samplers, AreUniformOverSequences) {
    for (const auto& [name, s] : samplers_) {
        EXPECT_TRUE(holds(contracts::sampler_uniformity(*s, {}))) << name;
    }
}

TEST_F(Samplers, J3_J4_SequencesAndSeedsAreIndependent) {
    constexpr std::size_t n = 20000;
    for (const auto& [name, s] : samplers_) {
        SCOPED_TRACE(name);
        EXPECT_TRUE(holds(contracts::sampler_sequences(*s, {})));
        const Sampler& other_seed = make(name, sample_count, 1);
        std::vector<double> first, seeded;
        for (std::uint64_t i = 0; i < n; ++i) {
            first.push_back(static_cast<double>(s->sample_1d(i, 3, 0)));
            seeded.push_back(static_cast<double>(other_seed.sample_1d(i, 3, 0)));
        }
        const double limit = 4 / std::sqrt(static_cast<double>(n));
        EXPECT_LT(std::abs(contracts::correlation(first, seeded)), limit);
    }
}

TEST_F(Samplers, J5_PairsOfDimensionsAreIndependent) {
    for (const auto& [name, s] : samplers_) {
        EXPECT_TRUE(holds(contracts::sampler_dimensions(*s, {}))) << name;
    }
}

TEST_F(Samplers, J9_StrataHoldOneSampleEach) {
    for (const auto& [name, s] : samplers_) {
        if (name == "independent") continue;
        SCOPED_TRACE(name);
        const auto count = static_cast<std::uint64_t>(exact_count(name));
        for (const std::uint64_t start :
             {std::uint64_t{0}, 5 * count, (std::uint64_t{1} << 32) / count * count}) {
            for (std::uint64_t sequence = 0; sequence < 20; ++sequence) {
                contracts::UnitGrid square(static_cast<int>(std::sqrt(count)));
                std::set<int> intervals;
                for (std::uint64_t i = start; i < start + count; ++i) {
                    square.add(s->sample_2d(sequence, i, 4));
                    const float x = s->sample_1d(sequence, i, 9);
                    intervals.insert(static_cast<int>(x * static_cast<float>(count)));
                }
                EXPECT_TRUE(square.equal());
                EXPECT_EQ(intervals.size(), count);
            }
        }
    }
}

/// The halves of the film are as well distributed as half as many samples can be.
TEST_F(Samplers, EvenAndOddSamplesAreStratifiedByThemselves) {
    for (const char* name : {"multijitter", "sobol", "stratified"}) {
        SCOPED_TRACE(name);
        const Sampler& s = make(name);
        for (std::uint64_t sequence = 0; sequence < 50; ++sequence) {
            for (const std::uint64_t half : {0u, 1u}) {
                // A cell of 4 × 4 holds two cells of either colour of the 8 × 8.
                contracts::UnitGrid square(4);
                for (std::uint64_t i = half; i < sample_count; i += 2) {
                    square.add(s.sample_2d(sequence, i, 0));
                }
                EXPECT_TRUE(square.equal());
            }
        }
    }
}

TEST_F(Samplers, OrthogonalArraysFillTheGridOfEveryPairOfDimensions) {
    const Sampler& s = make("orthogonal", 49);
    for (std::uint64_t sequence = 0; sequence < 20; ++sequence) {
        for (std::uint32_t a = 0; a < 8; ++a) {  // p + 1
            for (std::uint32_t b = 0; b < a; ++b) {
                contracts::UnitGrid square(7);
                std::set<int> intervals;
                for (std::uint64_t i = 0; i < 49; ++i) {
                    const auto at = [&](std::uint32_t d) {
                        return s.sample_2d(sequence, i, d & ~1u)[d & 1];
                    };
                    square.add({at(a), at(b)});
                    intervals.insert(static_cast<int>(at(a) * 49));
                }
                EXPECT_TRUE(square.equal()) << a << ", " << b;
                EXPECT_EQ(intervals.size(), 49u) << a;
            }
        }
    }
}

TEST_F(Samplers, J9_ProjectionsHoldOneSampleEach) {
    for (const char* name : {"multijitter", "sobol"}) {
        SCOPED_TRACE(name);
        const Sampler& s = make(name);
        for (std::uint64_t sequence = 0; sequence < 50; ++sequence) {
            std::set<int> columns, rows;
            for (std::uint64_t i = 0; i < sample_count; ++i) {
                const Vector2 p = s.sample_2d(sequence, i, 0);
                columns.insert(static_cast<int>(p.x * sample_count));
                rows.insert(static_cast<int>(p.y * sample_count));
            }
            EXPECT_EQ(columns.size(), std::size_t{sample_count});
            EXPECT_EQ(rows.size(), std::size_t{sample_count});
        }
    }
}

TEST(SobolSampler, J9_AlignedBlocksFillAllElementaryIntervals) {
    Workshop workshop;
    const Sampler& s = workshop.make<Sampler>("<sampler type='sobol'/>");
    for (const int log_size : {1, 3, 6, 10}) {
        const std::uint64_t size = std::uint64_t{1} << log_size;
        for (std::uint64_t block = 0; block < 4; ++block) {
            for (int log_x = 0; log_x <= log_size; ++log_x) {
                const auto columns = static_cast<float>(1 << log_x);
                const auto rows = static_cast<float>(1 << (log_size - log_x));
                std::set<std::pair<int, int>> seen;
                for (std::uint64_t i = block * size; i < (block + 1) * size; ++i) {
                    const Vector2 p = s.sample_2d(9, i, 6);
                    seen.emplace(static_cast<int>(p.x * columns), static_cast<int>(p.y * rows));
                }
                EXPECT_EQ(seen.size(), size);
            }
        }
    }
}

/// The halves of a Sobol' sequence in its first pair, (1, m − 1, 2)-nets: two points in every
/// elementary interval of twice the smallest area.
TEST(SobolSampler, HalvesOfTheFirstPairAreNets) {
    Workshop workshop;
    const Sampler& s = workshop.make<Sampler>("<sampler type='sobol'/>");
    for (const int log_size : {4, 5, 6, 9, 10}) {
        const std::uint64_t size = std::uint64_t{1} << log_size;
        for (std::uint64_t half = 0; half < 8; ++half) {  // of four blocks
            for (int log_x = 0; log_x <= log_size - 2; ++log_x) {
                const auto columns = static_cast<float>(1 << log_x);
                const auto rows = static_cast<float>(1 << (log_size - 2 - log_x));
                std::map<std::pair<int, int>, int> counts;
                for (std::uint64_t i = half / 2 * size + half % 2; i < (half / 2 + 1) * size;
                     i += 2) {
                    const Vector2 p = s.sample_2d(9, i, 0);
                    ++counts[{static_cast<int>(p.x * columns), static_cast<int>(p.y * rows)}];
                }
                EXPECT_EQ(counts.size(), size / 4);
                for (const auto& [cell, count] : counts) EXPECT_EQ(count, 2);
            }
        }
    }
}

/// Projections to two pairs of a group: what padding would leave to chance, or make worse.
TEST(SobolSampler, ProductsOverPairsOfAGroupHaveLittleVariance) {
    Workshop workshop;
    const auto variance = [&](const std::string& type, std::uint32_t a, std::uint32_t b) {
        const int samples = exact_count(type);
        const Sampler& s = workshop.make<Sampler>(sampler(type, whole("sample_count", samples)));
        RunningStatistics means;
        for (std::uint64_t sequence = 0; sequence < 1000; ++sequence) {
            double sum = 0;
            for (int k = 0; k < samples; ++k) {
                const auto i = static_cast<std::uint64_t>(k);
                const Vector2 p = s.sample_2d(sequence, i, a), q = s.sample_2d(sequence, i, b);
                sum += double((p.x - 0.5f) * (q.x - 0.5f) + (p.y - 0.5f) * (q.y - 0.5f));
            }
            means.add(sum / samples);
        }
        return means.variance();
    };
    // Film and light, film and direction, light and choice of the light.
    for (const auto& [a, b] : {std::pair{0u, 10u}, {0u, 4u}, {8u, 10u}}) {
        EXPECT_LT(variance("sobol", a, b), variance("independent", a, b) / 4) << a << ", " << b;
        if (b >= 8) continue;  // p + 1 dimensions form an array
        EXPECT_LT(variance("orthogonal", a, b), variance("independent", a, b) / 4);
    }
}

TEST_F(Samplers, J6_MeansAreUnbiasedForAnySampleCount) {
    // ∫∫ f = (e − 1)², of a product that is neither symmetric nor linear.
    const double exact = sqr(std::numbers::e - 1);
    for (const auto& [name, _] : samplers_) {
        for (const int samples : {1, 2, 7, 16, 23, 100}) {
            SCOPED_TRACE(name + fmt::format(" with {} samples", samples));
            const Sampler& s = make(name, samples);
            EXPECT_GE(s.sample_count(), samples);
            RunningStatistics means;
            for (std::uint64_t sequence = 0; sequence < 2000; ++sequence) {
                double sum = 0;
                for (int i = 0; i < samples; ++i) {
                    const Vector2 p = s.sample_2d(sequence, static_cast<std::uint64_t>(i), 0);
                    sum += std::exp(static_cast<double>(p.x) + static_cast<double>(p.y));
                }
                means.add(sum / samples);
            }
            EXPECT_TRUE(mean_matches(means, exact, sidak(1e-2, 24)));
        }
    }
}

TEST_F(Samplers, StratificationLowersTheVariance) {
    const auto variance = [&](const Sampler& s) {
        RunningStatistics means;
        for (std::uint64_t sequence = 0; sequence < 1000; ++sequence) {
            double sum = 0;
            for (int i = 0; i < s.sample_count(); ++i) {
                const Vector2 p = s.sample_2d(sequence, static_cast<std::uint64_t>(i), 0);
                sum += std::exp(static_cast<double>(p.x) + static_cast<double>(p.y));
            }
            means.add(sum / s.sample_count());
        }
        return means.variance();
    };
    const double independent = variance(make("independent"));
    EXPECT_LT(variance(make("stratified")), independent / 20);
    EXPECT_LT(variance(make("multijitter")), independent / 20);
    EXPECT_LT(variance(make("orthogonal", 49)), independent / 20);
    EXPECT_LT(variance(make("sobol")), independent / 100);
}

TEST(Permutation, IsOneAndAllAreEquallyLikely) {
    for (const std::uint32_t n : {1u, 2u, 3u, 7u, 16u, 25u, 100u}) {
        const std::uint32_t shown = std::min(n, 16u);
        std::vector<double> images(std::size_t{shown} * n), pairs(std::size_t{n} * n);
        constexpr int keys = 40000;
        for (int k = 0; k < keys; ++k) {
            const std::uint64_t key = hash64({static_cast<std::uint64_t>(k), n});
            std::set<std::uint32_t> all;
            for (std::uint32_t i = 0; i < n; ++i) all.insert(permute(i, n, key));
            ASSERT_EQ(all.size(), n);
            ASSERT_LT(*all.rbegin(), n);
            for (std::uint32_t i = 0; i < shown; ++i) ++images[i * n + permute(i, n, key)];
            if (n > 1) ++pairs[permute(0, n, key) * n + permute(1, n, key)];
        }
        const std::vector<double> expected(images.size(), keys / static_cast<double>(n));
        EXPECT_TRUE(counts_match(images, expected, 1e-4, shown + n)) << n;
        if (n < 3) continue;
        std::vector<double> expected_pairs(pairs.size(), keys / static_cast<double>(n) / (n - 1));
        for (std::uint32_t i = 0; i < n; ++i) expected_pairs[i * n + i] = 0;
        EXPECT_TRUE(counts_match(pairs, expected_pairs, 1e-4)) << n;
    }
}

TEST(Sampler, RoundedSampleCountsAreTold) {
    Workshop workshop;
    const auto count = [&](const char* type, int samples) {
        return workshop.make<Sampler>(sampler(type, whole("sample_count", samples))).sample_count();
    };
    EXPECT_EQ(count("stratified", 10), 16);
    EXPECT_NE(workshop.warnings().find("changed to 16"), std::string::npos);
    EXPECT_EQ(count("orthogonal", 10), 25);
    EXPECT_NE(workshop.warnings().find("changed to 25"), std::string::npos);
    EXPECT_EQ(count("multijitter", 10), 12);
    EXPECT_NE(workshop.warnings().find("changed to 12"), std::string::npos);
    EXPECT_EQ(count("sobol", 10), 10);
    EXPECT_EQ(workshop.warnings(), "");
    EXPECT_NE(refusal(sampler("sobol", whole("sample_count", 0))), "");
}

TEST(Sampler, KnowsTheNamesOfOldScenes) {
    Workshop workshop;
    for (const char* name : {"bose", "bush"}) workshop.make<Sampler>(sampler(name, ""));
    workshop.make<Sampler>(sampler("ldsampler", whole("dimension", 4)));
    EXPECT_NE(workshop.warnings().find("\"dimension\" has no effect"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
