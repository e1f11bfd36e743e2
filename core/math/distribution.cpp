// SPDX-License-Identifier: Apache-2.0
/// Construction and sampling of tabulated distributions.
#include "core/math/distribution.h"

#include "core/math/rounding.h"

#include <stdexcept>

namespace lucerna {
namespace {

constexpr double largest_below_one = 0x1.fffffffffffffp-1;

double checked_weight(double weight) {
    if (!(weight >= 0) || !std::isfinite(weight)) {
        throw std::invalid_argument("a weight of a distribution is negative or not finite");
    }
    return weight;
}

/// Writes the running sums of `weights` divided by their total; returns the total. Bins behind
/// the last one that counts get exactly 1, so that a search for u < 1 never ends there.
template <typename T>
double cumulate(std::span<const T> weights, std::span<double> cdf) {
    double total = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        cdf[i] = total;
        total += checked_weight(static_cast<double>(weights[i]));
    }
    if (!std::isfinite(total)) throw std::invalid_argument("the weights' sum overflows");
    cdf[weights.size()] = total;
    if (total > 0) {
        for (double& c : cdf) c /= total;
    }
    return total;
}

/// The bin of n that holds x in [0, 1].
int bin_of(float x, int n) { return std::min(static_cast<int>(static_cast<double>(x) * n), n - 1); }

/// `x` moved by rounding errors into bin `bin` of n, so that it lies there as a float.
float inside_bin(double x, int bin, int n) {
    auto result = static_cast<float>(x);
    while (result >= 1 || bin_of(result, n) > bin) result = next_float_down(result);
    while (bin_of(result, n) < bin) result = next_float_up(result);
    return result;
}

/// The bin of u in [0, 1): the last with cdf[bin] <= u. Each step is a choice of two addresses and
/// no branch, which would be mispredicted half of the time.
PiecewiseConstant1D::Bin invert(std::span<const double> cdf, double u) {
    u = std::clamp(u, 0.0, largest_below_one);
    std::size_t bin = 0;
    for (std::size_t size = cdf.size() - 1; size > 1;) {
        const std::size_t half = size / 2;
        bin += cdf[bin + half] <= u ? half : 0;
        size -= half;
    }
    const double rest = (u - cdf[bin]) / (cdf[bin + 1] - cdf[bin]);
    return {static_cast<int>(bin), std::min(rest, largest_below_one)};
}

/// Probability of bin i; zero for an empty distribution.
double probability(std::span<const double> cdf, int i) {
    return cdf[static_cast<std::size_t>(i) + 1] - cdf[static_cast<std::size_t>(i)];
}

}  // namespace

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights)
    : bins_(weights.size()) {
    if (weights.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw std::invalid_argument("a distribution has more than 2^32 − 1 bins");
    }
    for (const double w : weights) total_ += checked_weight(w);
    if (!std::isfinite(total_)) throw std::invalid_argument("the weights' sum overflows");
    if (empty()) return;

    // Bins below the average borrow from one above it until all hold the average.
    const double n = static_cast<double>(weights.size());
    std::vector<double> filled(weights.size());
    std::vector<std::uint32_t> small, large;
    std::uint32_t heaviest = 0;
    for (std::uint32_t i = 0; i < weights.size(); ++i) {
        bins_[i].pmf = weights[i] / total_;
        filled[i] = bins_[i].pmf * n;
        (filled[i] < 1 ? small : large).push_back(i);
        if (weights[i] > weights[heaviest]) heaviest = i;
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t poor = small.back(), rich = large.back();
        small.pop_back();
        bins_[poor].threshold = filled[poor];
        bins_[poor].alias = rich;
        filled[rich] -= 1 - filled[poor];
        if (filled[rich] < 1) {
            large.pop_back();
            small.push_back(rich);
        }
    }
    // Only rounding leaves bins over: they are full, unless they must never be drawn.
    small.insert(small.end(), large.begin(), large.end());
    for (const std::uint32_t i : small) {
        bins_[i].threshold = weights[i] > 0 ? 1 : 0;
        bins_[i].alias = heaviest;
    }
}

DiscreteDistribution::Reused DiscreteDistribution::sample_reuse(double u) const {
    if (empty()) return {0, 0};
    const auto [i, rest] = place_of(u);
    const Bin& bin = bins_[i];
    if (rest < bin.threshold) return {i, std::min(rest / bin.threshold, largest_below_one)};
    return {bin.alias, std::min((rest - bin.threshold) / (1 - bin.threshold), largest_below_one)};
}

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const double> weights)
    : cdf_(weights.size() + 1), total_(cumulate(weights, std::span(cdf_))) {}

PiecewiseConstant1D::Bin PiecewiseConstant1D::sample_bin(double u) const { return invert(cdf_, u); }

PiecewiseConstant1D::Sample PiecewiseConstant1D::sample(double u) const {
    if (empty()) return {0, 0, 0};
    const auto [bin, rest] = sample_bin(u);
    return {inside_bin((bin + rest) / size(), bin, size()), static_cast<float>(pmf(bin) * size()),
            bin};
}

float PiecewiseConstant1D::pdf(float x) const {
    if (empty() || !(x >= 0 && x <= 1)) return 0;
    return static_cast<float>(pmf(bin_of(x, size())) * size());
}

double PiecewiseConstant1D::pmf(int index) const { return probability(cdf_, index); }

PiecewiseConstant2D::PiecewiseConstant2D(std::span<const float> weights, int width, int height,
                                         double alike)
    : size_(width, height) {
    if (width < 0 || height < 0 ||
        weights.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        throw std::invalid_argument("the weights of a 2D distribution do not fill its grid");
    }
    for (const float w : weights) total_ += checked_weight(static_cast<double>(w));
    if (!std::isfinite(total_)) throw std::invalid_argument("the weights' sum overflows");
    if (empty()) return;
    const Vector2i tiles = (size_ + side - 1) / side;
    columns_ = tiles.x;
    const auto columns = static_cast<std::size_t>(tiles.x),
               rows = static_cast<std::size_t>(tiles.y);
    row_cdfs_.resize(rows * (columns + 1));
    rows_cdf_.resize(rows + 1);
    std::vector<double> totals;
    for (std::size_t y = 0; y < rows; ++y) {
        std::vector<double> row;
        for (int x = 0; x < tiles.x; ++x) {
            const Vector2i index(x, static_cast<int>(y));
            tiles_.push_back(make_tile(weights, index, alike));
            const Vector2i inside = cells(index);
            row.push_back(static_cast<double>(tiles_.back().density) * inside.x * inside.y);
        }
        const std::span<double> cdf = std::span(row_cdfs_).subspan(y * (columns + 1), columns + 1);
        totals.push_back(cumulate(std::span<const double>(row), cdf));
    }
    cumulate(std::span<const double>(totals), std::span(rows_cdf_));
}

PiecewiseConstant2D::Tile PiecewiseConstant2D::make_tile(std::span<const float> weights,
                                                         Vector2i index, double alike) {
    const double scale = static_cast<double>(size_.x) * size_.y / total_;
    const Vector2i inside = cells(index);
    Details all;
    double sum = 0, most = 0;
    for (int y = 0; y < inside.y; ++y) {
        for (int x = 0; x < inside.x; ++x) {
            const auto column = static_cast<std::size_t>(side * index.x + x);
            const auto row = static_cast<std::size_t>(side * index.y + y);
            const double density =
                scale *
                static_cast<double>(weights[column + row * static_cast<std::size_t>(size_.x)]);
            all.density[y][x] = static_cast<float>(density);
            all.row_sums[y] += all.density[y][x];
            sum += density;
            most = std::max(most, density);
        }
    }
    const double mean = sum / (inside.x * inside.y);
    Tile tile = {.density = static_cast<float>(mean)};
    if (most > alike * mean) {
        tile.details = static_cast<std::uint32_t>(details_.size());
        details_.push_back(all);
    }
    return tile;
}

namespace {

/// The bin with one of the given weights, not all zero, that lies at u in [0, 1), and what is left
/// of u.
PiecewiseConstant1D::Bin choose(const float (&weights)[PiecewiseConstant2D::side], double u) {
    constexpr int count = PiecewiseConstant2D::side;
    double sums[count + 1] = {};
    for (int i = 0; i < count; ++i) sums[i + 1] = sums[i] + static_cast<double>(weights[i]);
    const double place = u * sums[count];
    int bin = 0;
    for (int i = 1; i < count; ++i) bin += sums[i] <= place ? 1 : 0;
    while (!(weights[bin] > 0)) --bin;  // if `place` has been rounded up to the end
    const double rest = (place - sums[bin]) / static_cast<double>(weights[bin]);
    return {bin, std::clamp(rest, 0.0, largest_below_one)};
}

}  // namespace

PiecewiseConstant2D::Sample PiecewiseConstant2D::sample(Vector2d u) const {
    if (empty()) return {Vector2(0), 0};
    auto y = invert(rows_cdf_, u.y);
    auto x = invert(row(y.index), u.x);
    const Vector2i index(x.index, y.index), inside = cells(index);
    const Tile& tile = this->tile(index);
    float density = tile.density;
    if (tile.details == none) {
        const auto split = [](PiecewiseConstant1D::Bin& bin, int count) {
            const double place = bin.u * count;
            bin.index = std::min(static_cast<int>(place), count - 1);
            bin.u = place - bin.index;
        };
        split(x, inside.x);
        split(y, inside.y);
    } else {
        const Details& details = details_[tile.details];
        y = choose(details.row_sums, y.u);
        x = choose(details.density[y.index], x.u);
        density = details.density[y.index][x.index];
    }
    const Vector2i cell = side * index + Vector2i(x.index, y.index);
    return {{inside_bin((cell.x + x.u) / size_.x, cell.x, size_.x),
             inside_bin((cell.y + y.u) / size_.y, cell.y, size_.y)},
            density};
}

float PiecewiseConstant2D::pdf(Vector2 p) const {
    if (empty() || !(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) return 0;
    const Vector2i cell(bin_of(p.x, size_.x), bin_of(p.y, size_.y));
    const Tile& tile = this->tile(cell / side);
    if (tile.details == none) return tile.density;
    return details_[tile.details].density[cell.y % side][cell.x % side];
}

}  // namespace lucerna
