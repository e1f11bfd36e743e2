// SPDX-License-Identifier: Apache-2.0
/// stratified: one sample at random in each cell of a grid, in random order.
///
/// n samples fill a grid of √n × √n cells in 2D and n cells in 1D; another order and another jitter
/// for each dimension (Mitchell 1996, "Consequences of Stratified Sampling in Graphics"). Samples
/// beyond the first n start a new pattern. The sample count is raised to a square.
#include "plugins/samplers/seeded.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

class StratifiedSampler final : public SeededSampler {
public:
    explicit StratifiedSampler(const Params& params) : SeededSampler(params) {
        params.no_effect("jitter", "samples are always jittered: fixed positions are biased");
        const auto wanted = static_cast<double>(sample_count_);
        side_ = static_cast<std::uint32_t>(std::min(std::ceil(std::sqrt(wanted)), 46340.0));
        cells_ = side_ * side_;
        if (static_cast<std::uint32_t>(sample_count_) == cells_) return;
        params.warning("sample_count",
                       fmt::format("sample_count is {}: changed to {}, the next square",
                                   sample_count_, cells_));
        sample_count_ = static_cast<int>(cells_);
    }

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        const std::uint64_t h = hash_combine(key(sequence, dimension), index / cells_);
        const auto i = static_cast<std::uint32_t>(index % cells_);
        const std::uint64_t jitter = mix64(h + i + 1);
        const double x = shuffled_cell(i, cells_, 1, h) + uint64_to_double(jitter);
        return std::min(static_cast<float>(x / cells_), one_minus_epsilon);
    }

    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        const std::uint64_t h = hash_combine(key(sequence, dimension), index / cells_);
        const auto i = static_cast<std::uint32_t>(index % cells_);
        const std::uint64_t jitter = mix64(h + i + 1);
        const std::uint32_t cell = shuffled_cell(i, cells_, side_, h);
        const double x = cell % side_ + uint_to_double(static_cast<std::uint32_t>(jitter));
        const double y = cell / side_ + uint_to_double(static_cast<std::uint32_t>(jitter >> 32));
        return {std::min(static_cast<float>(x / side_), one_minus_epsilon),
                std::min(static_cast<float>(y / side_), one_minus_epsilon)};
    }

private:
    std::uint32_t side_ = 1, cells_ = 1;
};

}  // namespace

const PluginInfo plugin = describe<StratifiedSampler>("one sample in each cell of a grid");

}  // namespace lucerna
