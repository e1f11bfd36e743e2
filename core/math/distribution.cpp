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

void InversionGuide::fill(std::span<const double> cdf, std::span<std::uint32_t> guide) {
    const std::size_t bins = cdf.size() - 1;
    std::size_t bin = 0;
    for (std::size_t k = 0; k < guide.size(); ++k) {
        const double u = static_cast<double>(k) / static_cast<double>(guide.size() - 1);
        while (bin + 1 < bins && cdf[bin + 1] <= u) ++bin;
        guide[k] = static_cast<std::uint32_t>(bin);
    }
}

std::size_t InversionGuide::find(std::span<const double> cdf, std::span<const std::uint32_t> guide,
                                 double u) {
    const std::size_t cells = guide.size() - 1;
    const auto k = std::min(static_cast<std::size_t>(u * static_cast<double>(cells)), cells - 1);
    // The product may have been rounded up to the next cell.
    const std::size_t first = cdf[guide[k]] <= u ? guide[k] : guide[k - 1];
    const auto begin = cdf.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = cdf.begin() + static_cast<std::ptrdiff_t>(guide[k + 1]) + 1;
    return static_cast<std::size_t>(std::upper_bound(begin, end, u) - cdf.begin()) - 1;
}

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const double> weights)
    : cdf_(weights.size() + 1),
      guide_(InversionGuide::size(weights.size())),
      total_(cumulate(weights, std::span(cdf_))) {
    InversionGuide::fill(cdf_, guide_);
}

PiecewiseConstant1D::Bin PiecewiseConstant1D::sample_bin(double u) const {
    u = std::clamp(u, 0.0, largest_below_one);
    const std::size_t index = InversionGuide::find(cdf_, guide_, u);
    const double rest = (u - cdf_[index]) / (cdf_[index + 1] - cdf_[index]);
    return {static_cast<int>(index), std::min(rest, largest_below_one)};
}

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
    std::vector<double> totals;
    for (int y = 0; y < tiles.y; ++y) {
        std::vector<double> row;
        for (int x = 0; x < tiles.x; ++x) {
            tiles_.push_back(make_tile(weights, {x, y}, alike));
            const Vector2i inside = cells({x, y});
            row.push_back(static_cast<double>(tiles_.back().density) * inside.x * inside.y);
        }
        columns_.emplace_back(row);
        totals.push_back(columns_.back().total());
    }
    rows_ = PiecewiseConstant1D(totals);
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
template <typename Weight>
PiecewiseConstant1D::Bin choose(int count, double total, double u, const Weight& weight) {
    double left = u * total, chosen = 0;
    int bin = -1;
    for (int i = 0; i < count; ++i) {
        const double w = weight(i);
        if (!(w > 0)) continue;
        if (bin >= 0) {
            if (left < chosen) break;
            left -= chosen;
        }
        bin = i;
        chosen = w;
    }
    return {bin, std::clamp(left / chosen, 0.0, largest_below_one)};
}

}  // namespace

PiecewiseConstant2D::Sample PiecewiseConstant2D::sample(Vector2d u) const {
    if (empty()) return {Vector2(0), 0};
    auto y = rows_.sample_bin(u.y);
    auto x = columns_[static_cast<std::size_t>(y.index)].sample_bin(u.x);
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
        const auto row_sum = [&](int i) {
            double sum = 0;
            for (const float d : details.density[i]) sum += static_cast<double>(d);
            return sum;
        };
        double total = 0;
        for (int i = 0; i < side; ++i) total += row_sum(i);
        y = choose(side, total, y.u, row_sum);
        const auto& row = details.density[y.index];
        x = choose(side, row_sum(y.index), x.u, [&](int i) { return static_cast<double>(row[i]); });
        density = row[x.index];
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
