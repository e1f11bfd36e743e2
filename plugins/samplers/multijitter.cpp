// SPDX-License-Identifier: Apache-2.0
/// multijitter: samples that are stratified in 2D and in both projections.
///
/// n = columns · rows samples lie one in each cell of the grid, one in each of n columns and one in
/// each of n rows; the shuffles are correlated, which keeps samples apart (Kensler 2013,
/// "Correlated Multi-Jittered Sampling"). Samples beyond the first n start a new pattern. The
/// sample count is raised to a product of two almost equal numbers.
#include "plugins/samplers/seeded.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

class MultiJitterSampler final : public SeededSampler {
public:
    explicit MultiJitterSampler(const Params& params) : SeededSampler(params) {
        params.no_effect("jitter", "samples are always jittered: fixed positions are biased");
        const auto wanted = static_cast<std::uint32_t>(std::min(sample_count_, largest));
        columns_ = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(wanted)));
        rows_ = (wanted + columns_ - 1) / columns_;
        cells_ = columns_ * rows_;
        if (static_cast<std::uint32_t>(sample_count_) == cells_) return;
        params.warning("sample_count", fmt::format("sample_count is {}: changed to {} = {} × {}",
                                                   sample_count_, cells_, columns_, rows_));
        sample_count_ = static_cast<int>(cells_);
    }

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        const std::uint64_t h = hash_combine(key(sequence, dimension), index / cells_);
        const auto i = static_cast<std::uint32_t>(index % cells_);
        const double x = shuffled_cell(i, cells_, 1, h) + uint64_to_double(mix64(h + i + 1));
        return std::min(static_cast<float>(x / cells_), one_minus_epsilon);
    }

    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        const std::uint64_t h = hash_combine(key(sequence, dimension), index / cells_);
        const auto i = static_cast<std::uint32_t>(index % cells_);
        const std::uint64_t jitter = mix64(h + i + 1);
        const std::uint32_t cell = shuffled_cell(i, cells_, columns_, h);
        const std::uint32_t column = cell % columns_, row = cell / columns_;
        // The cell's column decides where its sample lies in y, its row where it lies in x.
        const std::uint32_t sub_row = permute(column, columns_, mix64(~h));
        const std::uint32_t sub_column = permute(row, rows_, hash64({h}));
        const double jx = uint_to_double(static_cast<std::uint32_t>(jitter));
        const double jy = uint_to_double(static_cast<std::uint32_t>(jitter >> 32));
        const double x = (column + (sub_column + jx) / rows_) / columns_;
        const double y = (row + (sub_row + jy) / columns_) / rows_;
        return {std::min(static_cast<float>(x), one_minus_epsilon),
                std::min(static_cast<float>(y), one_minus_epsilon)};
    }

private:
    static constexpr int largest = 1 << 30;  // keeps columns · rows in 32 bits
    std::uint32_t columns_ = 1, rows_ = 1, cells_ = 1;
};

}  // namespace

const PluginInfo plugin = describe<MultiJitterSampler>("correlated multi-jittered samples");

}  // namespace lucerna
