// SPDX-License-Identifier: Apache-2.0
#include "core/image/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "core/base/error.h"
#include "core/image/color.h"

namespace lucerna {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

void check_sizes(const Image& image, const Image& reference) {
    if (image.width == reference.width && image.height == reference.height) return;
    throw Error(fmt::format(
        "images of {} x {} and {} x {} pixels cannot be compared; render both at one size",
        image.width, image.height, reference.width, reference.height));
}

double sum(Vector3d v) { return v.x + v.y + v.z; }

/// Mean over channels of the squared error relative to the reference.
double relative_error(Vector3d x, Vector3d r, double epsilon) {
    double error = 0;
    for (int c = 0; c < 3; ++c) {
        const double difference2 = sqr(x[c] - r[c]);
        // Equal is equal, also where a black reference makes this 0/0.
        if (difference2 > 0) error += difference2 / (sqr(r[c]) + epsilon);
    }
    return error / 3;
}

/// Mean over channels of the squared error of what an sRGB display shows.
double display_error(Color x, Color r) {
    const auto shown = [](Color c) {
        return Vector3d(linear_to_srgb(glm::clamp(c, Color(0), Color(1))));
    };
    const Vector3d difference = shown(x) - shown(r);
    return sum(difference * difference) / 3;
}

/// Moves the largest tenth of a percent of the errors to the end and returns their number.
std::size_t partition_worst(std::vector<double>& errors) {
    const std::size_t worst = errors.size() / 1000;
    if (worst > 0) {
        const auto kept = errors.end() - static_cast<std::ptrdiff_t>(worst);
        std::nth_element(errors.begin(), kept, errors.end());
    }
    return worst;
}

}  // namespace

Comparison compare_images(const Image& image, const Image& reference) {
    check_sizes(image, reference);
    Comparison result;
    result.pixels = image.pixel_count();
    std::vector<std::size_t> finite;
    finite.reserve(result.pixels);
    double reference_sum = 0;
    for (std::size_t i = 0; i < result.pixels; ++i) {
        const Color r = reference.rgb(i);
        const bool x_finite = is_finite(image.rgb(i)), r_finite = is_finite(r);
        result.non_finite += x_finite ? 0 : 1;
        result.non_finite_reference += r_finite ? 0 : 1;
        if (r_finite) reference_sum += sum(Vector3d(r));
        if (x_finite && r_finite) finite.push_back(i);
    }
    const std::size_t measured = result.pixels - result.non_finite_reference;
    if (measured > 0) result.reference_mean = reference_sum / (3 * static_cast<double>(measured));
    result.epsilon = 1e-2 * sqr(result.reference_mean);

    double squared = 0, shown = 0;
    std::vector<double> relative;
    relative.reserve(finite.size());
    for (const std::size_t i : finite) {
        const Color x = image.rgb(i), r = reference.rgb(i);
        const Vector3d difference = Vector3d(x) - Vector3d(r);
        squared += sum(difference * difference) / 3;
        shown += display_error(x, r);
        relative.push_back(relative_error(Vector3d(x), Vector3d(r), result.epsilon));
    }

    // Sums in the order of the pixels, before they are rearranged. Without a single finite pixel
    // nothing is known, and that is no praise.
    Metrics& m = result.finite;
    const auto count = static_cast<double>(finite.size());
    const double total = std::accumulate(relative.begin(), relative.end(), 0.0);
    m.mse = finite.empty() ? infinite : squared / count;
    m.rmse = std::sqrt(m.mse);
    m.relmse = finite.empty() ? infinite : total / count;
    m.psnr = finite.empty() ? -infinite : -10 * std::log10(shown / count);
    result.trimmed_pixels = partition_worst(relative);
    const auto worst = relative.end() - static_cast<std::ptrdiff_t>(result.trimmed_pixels);
    const double kept = std::accumulate(relative.begin(), worst, 0.0);
    const double dropped = std::accumulate(worst, relative.end(), 0.0);
    m.trimmed_relmse =
        finite.empty() ? infinite : kept / (count - static_cast<double>(result.trimmed_pixels));
    m.trimmed_share = kept + dropped > 0 ? dropped / (kept + dropped) : 0;

    const bool all_finite = finite.size() == result.pixels;
    result.all = all_finite ? m : Metrics{infinite, infinite, infinite, infinite, 1, -infinite};
    return result;
}

Image error_image(const Image& image, const Image& reference, double epsilon) {
    check_sizes(image, reference);
    Image map(image.width, image.height, {"Y"});
    for (std::size_t i = 0; i < map.pixel_count(); ++i) {
        const Color x = image.rgb(i), r = reference.rgb(i);
        const bool finite = is_finite(x) && is_finite(r);
        const double error = finite ? relative_error(Vector3d(x), Vector3d(r), epsilon) : infinite;
        map.pixels[i] = static_cast<float>(error);
    }
    return map;
}

Image8 false_color(const Image& map, float maximum) {
    // A polynomial of degree six through "magma", constant term first.
    static const Vector3d coefficients[] = {
        {-0.002136, -0.000750, -0.005386},  {0.251661, 0.677523, 2.494027},
        {8.353717, -3.577720, 0.314468},    {-27.668733, 14.264731, -13.649213},
        {52.176140, -27.943606, 12.944169}, {-50.768525, 29.046583, 4.234153},
        {18.655706, -11.489774, -5.601962}};
    Image8 result{.width = map.width, .height = map.height, .channel_count = 3};
    result.pixels.reserve(3 * map.pixel_count());
    for (std::size_t i = 0; i < map.pixel_count(); ++i) {
        const float value = map.rgb(i).x;
        Vector3d color(1);
        if (std::isfinite(value)) {
            const double t =
                maximum > 0 ? std::clamp(double{value} / double{maximum}, 0.0, 1.0) : 0;
            color = Vector3d(0);
            for (int k = 6; k >= 0; --k) color = color * t + coefficients[k];
        } else {
            ++result.non_finite;
        }
        for (int c = 0; c < 3; ++c) {
            const double v = std::clamp(color[c], 0.0, 1.0);
            result.pixels.push_back(static_cast<std::uint8_t>(v * 255 + 0.5));
        }
    }
    return result;
}

}  // namespace lucerna
