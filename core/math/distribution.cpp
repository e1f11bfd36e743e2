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

struct Found {
    int index;
    float x;
    /// Probability of the bin.
    double probability;
};

/// Inverts a cumulative distribution; x lies in the bin also after rounding to float.
Found invert(std::span<const double> cdf, std::span<const std::uint32_t> guide, double u) {
    u = std::clamp(u, 0.0, largest_below_one);
    const int n = static_cast<int>(cdf.size()) - 1;
    const std::size_t index = InversionGuide::find(cdf, guide, u);
    const int bin = static_cast<int>(index);
    const double probability = cdf[index + 1] - cdf[index];
    float x = static_cast<float>((bin + (u - cdf[index]) / probability) / n);
    while (x >= 1 || bin_of(x, n) > bin) x = next_float_down(x);
    while (bin_of(x, n) < bin) x = next_float_up(x);
    return {bin, x, probability};
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

PiecewiseConstant1D::Sample PiecewiseConstant1D::sample(double u) const {
    if (empty()) return {0, 0, 0};
    const Found found = invert(cdf_, guide_, u);
    return {found.x, static_cast<float>(found.probability * size()), found.index};
}

float PiecewiseConstant1D::pdf(float x) const {
    if (empty() || !(x >= 0 && x <= 1)) return 0;
    return static_cast<float>(pmf(bin_of(x, size())) * size());
}

double PiecewiseConstant1D::pmf(int index) const { return probability(cdf_, index); }

PiecewiseConstant2D::PiecewiseConstant2D(std::span<const float> weights, int width, int height)
    : width_(width) {
    if (width < 0 || height < 0 ||
        weights.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        throw std::invalid_argument("the weights of a 2D distribution do not fill its grid");
    }
    const auto columns = static_cast<std::size_t>(width);
    std::vector<double> totals(static_cast<std::size_t>(height));
    const std::size_t guide_size = InversionGuide::size(columns);
    cdfs_.resize(totals.size() * (columns + 1));
    guides_.resize(totals.size() * guide_size);
    for (std::size_t row = 0; row < totals.size(); ++row) {
        const auto cdf = std::span(cdfs_).subspan(row * (columns + 1), columns + 1);
        totals[row] = cumulate(weights.subspan(row * columns, columns), cdf);
        InversionGuide::fill(cdf, std::span(guides_).subspan(row * guide_size, guide_size));
    }
    rows_ = PiecewiseConstant1D(totals);
}

PiecewiseConstant2D::Sample PiecewiseConstant2D::sample(Vector2d u) const {
    if (empty()) return {Vector2(0), 0, Vector2i(0)};
    const PiecewiseConstant1D::Sample row = rows_.sample(u.y);
    const Found found = invert(row_cdf(row.index), row_guide(row.index), u.x);
    const double density = rows_.pmf(row.index) * height() * found.probability * width_;
    return {{found.x, row.x}, static_cast<float>(density), {found.index, row.index}};
}

float PiecewiseConstant2D::pdf(Vector2 p) const {
    if (empty() || !(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) return 0;
    const int row = bin_of(p.y, height());
    const double in_row = probability(row_cdf(row), bin_of(p.x, width_));
    return static_cast<float>(rows_.pmf(row) * height() * in_row * width_);
}

std::span<const double> PiecewiseConstant2D::row_cdf(int row) const {
    const std::size_t stride = static_cast<std::size_t>(width_) + 1;
    return std::span(cdfs_).subspan(static_cast<std::size_t>(row) * stride, stride);
}

std::span<const std::uint32_t> PiecewiseConstant2D::row_guide(int row) const {
    const std::size_t size = InversionGuide::size(static_cast<std::size_t>(width_));
    return std::span(guides_).subspan(static_cast<std::size_t>(row) * size, size);
}

}  // namespace lucerna
