// SPDX-License-Identifier: Apache-2.0
/// orthogonal: samples that are stratified in all pairs of many dimensions at once.
///
/// p² samples for a prime p form an orthogonal array of strength 2: any two of up to p + 1
/// dimensions have one sample in each cell of a grid of p × p, and each dimension has one in each
/// of p² intervals (Bose 1938; Jarosz et al. 2019, "Orthogonal Array Sampling for Monte Carlo
/// Rendering", 3.1 and 4.1). Further dimensions begin new arrays, and samples beyond the first p²,
/// too. The sample count is raised to the square of a prime.
#include "plugins/samplers/seeded.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

bool is_prime(std::uint32_t n) {
    for (std::uint32_t i = 2; i * i <= n; ++i) {
        if (n % i == 0) return false;
    }
    return n > 1;
}

class OrthogonalSampler final : public SeededSampler {
public:
    explicit OrthogonalSampler(const Params& params) : SeededSampler(params) {
        params.no_effect("jitter", "samples are always jittered: fixed positions are biased");
        const auto wanted = static_cast<std::uint32_t>(std::min(sample_count_, largest));
        while (levels_ * levels_ < wanted || !is_prime(levels_)) ++levels_;
        cells_ = levels_ * levels_;
        pairs_ = (levels_ + 1) / 2;
        if (static_cast<std::uint32_t>(sample_count_) == cells_) return;
        params.warning("sample_count",
                       fmt::format("sample_count is {}: changed to {}, the next square of a prime",
                                   sample_count_, cells_));
        sample_count_ = static_cast<int>(cells_);
    }

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        return sample_2d(sequence, index, dimension).x;
    }

    /// Pairs that begin at odd dimensions have arrays of their own.
    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        const std::uint32_t pair = dimension / 2 % pairs_;
        const std::uint64_t h = hash_combine(key(sequence, dimension - 2 * pair), index / cells_);
        const auto sample = static_cast<std::uint32_t>(index % cells_);
        const std::uint32_t row = permute(sample, cells_, h);
        const std::uint64_t jitter = mix64(h + (std::uint64_t{pair} << 32) + sample + 1);
        const std::uint32_t a = level(row, 2 * pair), b = level(row, 2 * pair + 1);
        const auto jx = static_cast<std::uint32_t>(jitter);
        const auto jy = static_cast<std::uint32_t>(jitter >> 32);
        return {place(a, b, jx, mix64(~h) + 2 * pair), place(b, a, jy, mix64(~h) + 2 * pair + 1)};
    }

private:
    static constexpr int largest = 46337 * 46337;  // the square of a prime, below 2³¹

    /// Entry of the array: the two digits of the row in base p, then their combinations a + k b.
    std::uint32_t level(std::uint32_t row, std::uint32_t column) const {
        const std::uint32_t a = row / levels_, b = row % levels_;
        if (column == 0) return a;
        return static_cast<std::uint32_t>((std::uint64_t{column - 1} * a + b) % levels_);
    }

    /// In the stratum of the level; the level of the other dimension of the pair decides where.
    float place(std::uint32_t level, std::uint32_t other, std::uint32_t jitter,
                std::uint64_t key) const {
        const std::uint32_t stratum = permute(level, levels_, mix64(key));
        const std::uint32_t part = permute(other, levels_, mix64(~key));
        const double x = stratum + (part + uint_to_double(jitter)) / levels_;
        return std::min(static_cast<float>(x / levels_), one_minus_epsilon);
    }

    std::uint32_t levels_ = 2, cells_ = 4, pairs_ = 1;
};

}  // namespace

const PluginInfo plugin = describe<OrthogonalSampler>("orthogonal arrays of strength 2");

}  // namespace lucerna
