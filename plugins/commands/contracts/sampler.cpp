// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/sampler.h"

#include <fmt/format.h>

#include <set>

namespace lucerna::contracts {

namespace {

constexpr std::uint64_t last = std::numeric_limits<std::uint64_t>::max();

}  // namespace

void UnitGrid::add(Vector2 p) {
    const auto at = [&](float x) {
        return static_cast<std::size_t>(x * static_cast<float>(side_));
    };
    ++counts_[at(p.y) * static_cast<std::size_t>(side_) + at(p.x)];
    ++total_;
}

Judgement UnitGrid::uniform() const {
    const std::vector<double> expected(counts_.size(),
                                       total_ / static_cast<double>(counts_.size()));
    return chi_square(counts_, expected);
}

bool UnitGrid::equal() const {
    return std::all_of(counts_.begin(), counts_.end(),
                       [&](double n) { return n == counts_.front(); });
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
    RunningStatistics x, y;
    for (const double v : a) x.add(v);
    for (const double v : b) y.add(v);
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - x.mean()) * (b[i] - y.mean());
    return sum / (static_cast<double>(a.size() - 1) * std::sqrt(x.variance() * y.variance()));
}

Evidence sampler_range(const Sampler& sampler) {
    Evidence evidence("numbers lie in [0, 1)");
    const auto inside = [](float x) { return x >= 0 && x < 1; };
    for (const std::uint64_t sequence : {std::uint64_t{0}, std::uint64_t{1}, last}) {
        for (const std::uint64_t start : {std::uint64_t{0}, (std::uint64_t{1} << 32) - 100,
                                          std::uint64_t{1} << 63, last - 199}) {
            for (std::uint64_t i = start; i - start < 200; ++i) {
                for (const std::uint32_t d : {0u, 1u, 1023u, 1024u, 2047u, 0xfffffffeu}) {
                    const float x = sampler.sample_1d(sequence, i, d);
                    const Vector2 p = sampler.sample_2d(sequence, i, d);
                    evidence.require(inside(x) && inside(p.x) && inside(p.y), [&] {
                        return fmt::format("{}, ({}, {}) in sequence {}, index {}, dimension {}", x,
                                           p.x, p.y, sequence, i, d);
                    });
                }
            }
        }
    }
    return evidence;
}

Evidence sampler_large_indices(const Sampler& sampler) {
    Evidence evidence("indices above 2³² are other samples");
    constexpr std::uint64_t above = std::uint64_t{1} << 32;
    int equal = 0;
    std::set<float> seen;
    for (std::uint64_t i = 0; i < 256; ++i) {
        equal += sampler.sample_1d(1, i, 3) == sampler.sample_1d(1, above + i, 3);
        seen.insert(sampler.sample_1d(1, above - 128 + i, 3));
    }
    evidence.require(equal <= 1, [&] { return fmt::format("{} of 256 are equal", equal); });
    evidence.require(seen.size() >= 255, [&] {
        return fmt::format("{} different numbers of 256 around 2³²", seen.size());
    });
    return evidence;
}

Evidence sampler_purity(const Sampler& sampler, const Sampler& again, const Effort& effort) {
    Evidence evidence("numbers do not depend on the order");
    const auto n = static_cast<std::uint64_t>(effort.part(200));
    std::vector<Vector2> forward;
    for (std::uint64_t i = 0; i < n; ++i) forward.push_back(sampler.sample_2d(7, i, 4));
    for (std::uint64_t i = n; i-- > 0;) {
        const Vector2 p = again.sample_2d(7, i, 4);
        evidence.require(p == forward[i], [&] {
            return fmt::format("index {}: ({}, {}), then ({}, {})", i, forward[i].x, forward[i].y,
                               p.x, p.y);
        });
    }
    return evidence;
}

Evidence sampler_blocks(const Sampler& sampler) {
    Evidence evidence("blocks and streams hold the pairs");
    constexpr std::uint64_t sequence = 0x123456789abcdef;
    const auto must = [&](bool holds, const char* what, std::uint64_t index, std::uint32_t d) {
        evidence.require(
            holds, [&] { return fmt::format("{} at index {}, dimension {}", what, index, d); });
    };
    for (const std::uint64_t index : {std::uint64_t{0}, std::uint64_t{37}, last}) {
        for (const std::uint32_t dimension : {0u, 3u, 1022u}) {
            SamplerBatch::Pairs pairs;
            const std::uint32_t count =
                sampler.batch().sample_pairs(sampler, sequence, index, dimension, pairs);
            must(count >= 1 && count <= SamplerBatch::most_pairs, "wrong length of a block", index,
                 dimension);
            SampleStream stream(sampler, sequence, index);
            stream.jump_to(dimension);
            for (std::uint32_t i = 0; i < 2 * SamplerBatch::most_pairs; ++i) {
                const Vector2 expected = sampler.sample_2d(sequence, index, dimension + 2 * i);
                if (i < count && i < SamplerBatch::most_pairs) {
                    must(pairs[i] == expected, "another pair in a block", index, dimension + 2 * i);
                }
                must(stream.next_2d() == expected, "another pair in a stream", index,
                     dimension + 2 * i);
            }
        }
    }
    for (std::uint32_t first = 0; first < 20; ++first) {
        SampleStream fresh(sampler, 77, 5);
        fresh.jump_to(first);
        must(fresh.next_2d() == sampler.sample_2d(77, 5, first), "another pair", 5, first);
    }
    SampleStream stream(sampler, 77, 5);
    for (const std::uint32_t dimension : {4u, 6u, 5u, 20u, 12u, 13u, 0u, 14u}) {
        stream.jump_to(dimension);
        must(stream.next_2d() == sampler.sample_2d(77, 5, dimension), "another pair after a jump",
             5, dimension);
        must(stream.next_1d() == sampler.sample_1d(77, 5, dimension + 2),
             "another number after a jump", 5, dimension + 2);
    }
    return evidence;
}

Evidence sampler_uniformity(const Sampler& sampler, const Effort& effort) {
    Evidence evidence("uniform over sequences (χ²)");
    for (const std::uint64_t index : {0u, 1u, 37u, 1000u}) {
        UnitGrid pairs(16), singles(16);
        const auto n = static_cast<std::uint64_t>(effort.part(6, 3000));
        for (std::uint64_t i = 0; i < n; ++i) {
            const std::uint64_t sequence = (effort.seed - 1) * n + i;
            pairs.add(sampler.sample_2d(sequence, index, 2));
            const float x = sampler.sample_1d(sequence, index, 5);
            const float y = sampler.sample_1d(sequence, index, 6);
            singles.add({x, y});
        }
        evidence.test(pairs.uniform(), fmt::format("of pairs at index {}", index));
        evidence.test(singles.uniform(), fmt::format("of two dimensions at index {}", index));
    }
    return evidence;
}

Evidence sampler_sequences(const Sampler& sampler, const Effort& effort) {
    Evidence evidence("sequences are independent");
    const int n = effort.part(10, 1000);
    std::vector<double> first, next, far;
    for (int i = 0; i < n; ++i) {
        // Over sequences, not indices: within one the samples are meant to depend.
        const auto s = static_cast<std::uint64_t>(i);
        first.push_back(static_cast<double>(sampler.sample_1d(s, 3, 0)));
        next.push_back(static_cast<double>(sampler.sample_1d(s + 1, 3, 0)));
        far.push_back(static_cast<double>(sampler.sample_1d(s + (std::uint64_t{1} << 32), 3, 0)));
    }
    for (const auto& [other, where] : {std::pair{&next, "of neighbours"}, {&far, "2³² apart"}}) {
        const double r = correlation(first, *other);
        evidence.test(
            {2 * normal_cdf(-std::abs(r) * std::sqrt(n)), fmt::format("correlation {:.3g}", r)},
            where);
    }
    return evidence;
}

Evidence sampler_dimensions(const Sampler& sampler, const Effort& effort) {
    Evidence evidence("pairs of dimensions are uniform (χ²)");
    Rng rng(hash64({effort.seed, 5}));
    const int n = effort.part(30, 1000);
    for (int pair = 0; pair < 24; ++pair) {
        const std::uint32_t a =
            pair < 8 ? static_cast<std::uint32_t>(pair) : rng.next_uint() % 2048;
        const std::uint32_t b = pair < 8 ? a + 1 : rng.next_uint() % 2048;
        if (a == b) continue;
        UnitGrid grid(8);
        std::vector<double> x_along, y_along;
        for (int i = 0; i < n; ++i) {
            const auto s = static_cast<std::uint64_t>(i);
            const float x = sampler.sample_1d(s, 5, a), y = sampler.sample_1d(s, 5, b);
            grid.add({x, y});
            x_along.push_back(static_cast<double>(sampler.sample_1d(7, s, a)));
            y_along.push_back(static_cast<double>(sampler.sample_1d(7, s, b)));
        }
        evidence.test(grid.uniform(), fmt::format("of dimensions {} and {}", a, b));
        // Blocks of samples move together, so this has more variance than if independent.
        const double r = correlation(x_along, y_along);
        evidence.require(std::abs(r) < 8 / std::sqrt(n), [&] {
            return fmt::format("dimensions {} and {} correlate by {:.3g} along a sequence", a, b,
                               r);
        });
    }
    return evidence;
}

std::vector<Evidence> check(const Sampler& sampler, const Sampler& again, const Effort& effort) {
    return {sampler_range(sampler),
            sampler_large_indices(sampler),
            sampler_purity(sampler, again, effort),
            sampler_blocks(sampler),
            sampler_uniformity(sampler, effort),
            sampler_sequences(sampler, effort),
            sampler_dimensions(sampler, effort)};
}

}  // namespace lucerna::contracts
