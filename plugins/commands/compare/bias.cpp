// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/bias.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

Blocks::Blocks(const Image& image) {
    const int size = block_size(image);
    const int columns = image.width / size, rows = image.height / size;
    means_.reserve(static_cast<std::size_t>(3) * static_cast<std::size_t>(columns * rows));
    for (int i = 0; i < columns * rows; ++i) {
        Vector3d sum(0);
        for (int j = 0; j < size * size; ++j) {
            sum +=
                Vector3d(image.rgb(i % columns * size + j % size, i / columns * size + j / size));
        }
        for (int c = 0; c < 3; ++c) means_.push_back(sum[c] / (size * size));
    }
}

int Blocks::block_size(const Image& image) {
    const double side = std::sqrt(double(image.width) * image.height / 400);
    return std::clamp(static_cast<int>(side), 1, 16);
}

double Blocks::mean() const {
    double sum = 0;
    for (const double x : means_) sum += x;
    return sum / static_cast<double>(means_.size());
}

std::vector<double> block_variances(const std::vector<Image>& halves, std::size_t count) {
    std::vector<double> result(count, 0.0);
    if (halves.size() != 2) return result;
    const Blocks a(halves[0]), b(halves[1]);
    for (std::size_t i = 0; i < count; ++i) {
        const double difference = (a.means()[i] - b.means()[i]) / 2;
        result[i] = difference * difference;
    }
    return result;
}

BiasTest test_bias(const BlockRuns& runs, const Blocks& reference,
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
