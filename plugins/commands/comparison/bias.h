// SPDX-License-Identifier: Apache-2.0
/// Does the mean of all repeats meet the reference?
///
/// Let x₁ … x_R be the repeats and r the reference, both averaged over blocks of pixels, so that
/// noise falls and a bias that has any extent stays.
///
///   whole picture  b = (⟨x̄⟩ − ⟨r⟩) / ⟨r⟩, with Student's interval over the repeats, widened by
///                  the variance of ⟨r⟩
///   blocks         β² = ⟨((x̄ − r)² − s²/R − v) / (r² + ε)⟩, where s² is the variance between
///                  the repeats, v = ((A − B)/2)² that of the reference from its two halves,
///                  ε = 0.01 ⟨r⟩²: an unbiased estimate of the squared relative bias, whose
///                  standard error comes from the blocks, which are independent
///
/// Both intervals have 99 %: a comparison of many variants should not cry wolf.
#pragma once

#include "core/image/image.h"
#include "plugins/commands/comparison/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

/// The means of an image over blocks of block_size² pixels, three channels each.
class Blocks {
public:
    Blocks() = default;
    explicit Blocks(const Image& image) {
        const int size = block_size(image);
        const int columns = image.width / size, rows = image.height / size;
        means_.reserve(static_cast<std::size_t>(3) * static_cast<std::size_t>(columns * rows));
        for (int i = 0; i < columns * rows; ++i) {
            Vector3d sum(0);
            for (int j = 0; j < size * size; ++j) {
                sum += Vector3d(
                    image.rgb(i % columns * size + j % size, i / columns * size + j / size));
            }
            for (int c = 0; c < 3; ++c) means_.push_back(sum[c] / (size * size));
        }
    }

    /// At most 16, and less for small pictures, so that there are some hundred blocks.
    static int block_size(const Image& image) {
        const double side = std::sqrt(double(image.width) * image.height / 400);
        return std::clamp(static_cast<int>(side), 1, 16);
    }
    const std::vector<double>& means() const { return means_; }
    double mean() const {
        double sum = 0;
        for (const double x : means_) sum += x;
        return sum / static_cast<double>(means_.size());
    }

private:
    std::vector<double> means_;
};

using BlockRuns = std::vector<Blocks>;

struct BiasTest {
    Interval brightness;  ///< relative difference of the means of the pictures
    /// Root mean square of the relative differences of blocks. low > 0: there is one.
    Interval local;
    bool biased = false;
};

/// The variance of the mean of each block of the reference; zero if it has no halves.
inline std::vector<double> block_variances(const std::vector<Image>& halves, std::size_t count) {
    std::vector<double> result(count, 0.0);
    if (halves.size() != 2) return result;
    const Blocks a(halves[0]), b(halves[1]);
    for (std::size_t i = 0; i < count; ++i) {
        const double difference = (a.means()[i] - b.means()[i]) / 2;
        result[i] = difference * difference;
    }
    return result;
}

/// Needs two runs at least; `variances` are block_variances() of the reference.
inline BiasTest test_bias(const BlockRuns& runs, const Blocks& reference,
                          const std::vector<double>& variances) {
    constexpr double confidence = 0.99;
    const std::vector<double>& r = reference.means();
    const double r_mean = reference.mean();
    if (!(r_mean > 0)) return {};
    const double epsilon = 0.01 * r_mean * r_mean;

    std::vector<double> brightness, squares;
    for (const Blocks& run : runs) brightness.push_back(run.mean() / r_mean - 1);
    // The three channels of a block share their noise, at worst all of it.
    double r_variance = 0;
    for (const double v : variances) r_variance += 3 * v / (double(r.size()) * double(r.size()));
    for (std::size_t i = 0; i + 2 < r.size(); i += 3) {
        double square = 0;
        for (std::size_t c = i; c < i + 3; ++c) {
            std::vector<double> differences;
            for (const Blocks& run : runs) differences.push_back(run.means()[c] - r[c]);
            const Mean mean = mean_of(differences);
            const double bias2 = mean.value * mean.value - mean.variance - variances[c];
            square += bias2 / (r[c] * r[c] + epsilon) / 3;
        }
        squares.push_back(square);
    }

    BiasTest test;
    const Mean whole = mean_of(brightness);
    const double margin = student_quantile(confidence, whole.degrees) *
                          std::sqrt(whole.variance + r_variance / (r_mean * r_mean));
    test.brightness = {whole.value, whole.value - margin, whole.value + margin};
    const Mean local = mean_of(squares);
    const double spread = student_quantile(confidence, local.degrees) * std::sqrt(local.variance);
    const auto root = [](double x) { return std::sqrt(std::max(x, 0.0)); };
    test.local = {root(local.value), root(local.value - spread), root(local.value + spread)};
    test.biased = test.local.low > 0 || test.brightness.low > 0 || test.brightness.high < 0;
    return test;
}

}  // namespace lucerna
