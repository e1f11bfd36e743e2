// SPDX-License-Identifier: Apache-2.0
/// Tabulated distributions: over indices, over an interval, over a rectangle.
///
/// Tables are built and searched in double: float sums drop whatever is 2⁻²⁴ of the rest, and a
/// float random number cannot tell a million bins apart. All samplers take doubles; give them
/// 32 bits or more (`uint_to_double`) where bins are many or uneven.
/// Weights must be finite and not negative, else std::invalid_argument. Bins of weight zero are
/// never drawn. If all weights are zero the distribution is `empty()`: its probabilities and
/// densities are zero, and a sample of it is marked by them.
#pragma once

#include "core/math/vector.h"

#include <span>
#include <vector>

namespace lucerna {

/// Indices 0 … size − 1 with given probabilities, drawn in constant time
/// (alias method: Walker 1977; construction after Vose 1991).
class DiscreteDistribution {
public:
    /// An index, and what is left of the random number, again uniform in [0, 1). It has
    /// lost the bits that chose the index.
    struct Reused {
        std::uint32_t index;
        double u;
    };

    DiscreteDistribution() = default;
    explicit DiscreteDistribution(std::span<const double> weights);

    std::uint32_t sample(double u) const {
        if (empty()) return 0;
        const auto [i, rest] = place_of(u);
        return rest < bins_[i].threshold ? i : bins_[i].alias;
    }
    Reused sample_reuse(double u) const;
    /// Probability of `index`: weight / total.
    double pmf(std::uint32_t index) const { return bins_[index].pmf; }

    std::size_t size() const { return bins_.size(); }
    bool empty() const { return !(total_ > 0); }
    /// Sum of the weights.
    double total() const { return total_; }

private:
    struct Bin {
        double pmf = 0;
        double threshold = 0;
        std::uint32_t alias = 0;
    };
    static constexpr double largest_below_one = 0x1.fffffffffffffp-1;

    /// The bin of the table at `u`, and where in it: in [0, 1).
    std::pair<std::uint32_t, double> place_of(double u) const {
        const double scaled = std::clamp(u, 0.0, largest_below_one) * static_cast<double>(size());
        const auto i =
            std::min(static_cast<std::uint32_t>(scaled), static_cast<std::uint32_t>(size() - 1));
        return {i, std::min(scaled - i, largest_below_one)};
    }

    std::vector<Bin> bins_;
    double total_ = 0;
};

/// A density on [0, 1] that is constant in each of n equal bins.
class PiecewiseConstant1D {
public:
    struct Sample {
        float x;
        float pdf;
        int index;
    };
    /// A bin, and what is left of the random number, again uniform in [0, 1).
    struct Bin {
        int index;
        double u;
    };

    PiecewiseConstant1D() = default;
    explicit PiecewiseConstant1D(std::span<const double> weights);

    Sample sample(double u) const;
    /// Only if it is not empty.
    Bin sample_bin(double u) const;
    /// Density at x in [0, 1]; zero outside.
    float pdf(float x) const;
    /// Probability of a bin.
    double pmf(int index) const;

    int size() const { return std::max(static_cast<int>(cdf_.size()) - 1, 0); }
    bool empty() const { return !(total_ > 0); }
    double total() const { return total_; }

private:
    std::vector<double> cdf_;
    double total_ = 0;
};

/// A density on [0, 1]² that is constant in each cell of a grid, for example the pixels of an
/// environment map. A tile of 8 × 8 cells is drawn first, then a cell of it. Tiles whose cells are
/// nearly alike have one density, so that what most draws read of a large grid stays in the nearer
/// caches. The map from u is monotonic in rows and in columns, which keeps what samplers stratify.
class PiecewiseConstant2D {
public:
    static constexpr int side = 8;  ///< of a tile

    struct Sample {
        Vector2 p;
        float pdf;
    };

    PiecewiseConstant2D() = default;
    /// `weights` holds rows of `width`, top row first (row 0 covers the smallest y). Where the
    /// largest weight of a tile is less than `alike` times its mean, all are taken as the mean.
    PiecewiseConstant2D(std::span<const float> weights, int width, int height, double alike = 1.5);

    Sample sample(Vector2d u) const;
    /// Density at p in [0, 1]²; zero outside.
    float pdf(Vector2 p) const;

    int width() const { return size_.x; }
    int height() const { return size_.y; }
    bool empty() const { return !(total_ > 0); }
    double total() const { return total_; }

private:
    static constexpr std::uint32_t none = 0xffffffff;
    struct Tile {
        float density = 0;             ///< mean of its cells
        std::uint32_t details = none;  ///< index of its cells, if they differ
    };
    struct alignas(32) Details {
        float row_sums[side] = {};
        float density[side][side] = {};  ///< zero beyond the grid
    };

    const Tile& tile(Vector2i index) const {
        return tiles_[static_cast<std::size_t>(index.x) +
                      static_cast<std::size_t>(index.y) * static_cast<std::size_t>(columns_)];
    }
    /// Cumulative distribution of the tiles of a row.
    std::span<const double> row(int y) const {
        const auto size = static_cast<std::size_t>(columns_) + 1;
        return std::span(row_cdfs_).subspan(static_cast<std::size_t>(y) * size, size);
    }
    /// The cells of a tile that are part of the grid.
    Vector2i cells(Vector2i tile) const { return glm::min(size_ - side * tile, Vector2i(side)); }
    Tile make_tile(std::span<const float> weights, Vector2i index, double alike);

    int columns_ = 0;               ///< number of tiles in a row
    std::vector<double> rows_cdf_;  ///< cumulative, over the rows of tiles
    std::vector<double> row_cdfs_;  ///< cumulative, over the tiles of each row in turn
    std::vector<Tile> tiles_;
    std::vector<Details> details_;
    Vector2i size_{0};
    double total_ = 0;
};

}  // namespace lucerna
