// SPDX-License-Identifier: Apache-2.0
#include "core/image/flip.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace lucerna {

namespace {

using Kernel = std::vector<float>;  // odd length, centre in the middle
using Channel = std::vector<float>;

/// The linear RGB and XYZ of the display, relative to its white; rows. IEC 61966-2-1.
const Matrix3d xyz_from_rgb(0.4123908, 0.2126390, 0.0193308, 0.3575843, 0.7151687, 0.1191948,
                            0.1804808, 0.0721923, 0.9505322);
const Vector3d white = xyz_from_rgb * Vector3d(1);

/// Opponent colours, linear in XYZ: the achromatic Y, red-green Cx, blue-yellow Cz.
Vector3d ycxcz_from_rgb(Vector3d rgb) {
    const Vector3d n = xyz_from_rgb * rgb / white;
    return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

Vector3d rgb_from_ycxcz(Vector3d opponent) {
    static const Matrix3d rgb_from_xyz = glm::inverse(xyz_from_rgb);
    const double y = (opponent.x + 16) / 116;
    const Vector3d n(y + opponent.y / 500, y, y - opponent.z / 200);
    return rgb_from_xyz * (n * white);
}

/// CIELAB with Hunt's adjustment: chroma counts for less in the dark.
Vector3d hunt_lab_from_rgb(Vector3d rgb) {
    const Vector3d n = xyz_from_rgb * rgb / white;
    const auto f = [](double t) {
        constexpr double delta = 6.0 / 29.0;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
    };
    const double fx = f(n.x), fy = f(n.y), fz = f(n.z), lightness = 116 * fy - 16;
    return {lightness, 0.01 * lightness * 500 * (fx - fy), 0.01 * lightness * 200 * (fy - fz)};
}

/// Abasi, Amani Tehran, Fairchild 2020: city block in lightness, Euclidean in chroma.
double hyab(Vector3d a, Vector3d b) {
    const Vector3d d = a - b;
    return std::abs(d.x) + std::sqrt(sqr(d.y) + sqr(d.z));
}

/// Compresses large colour differences: the lower 40 % of the range get 95 % of the result.
double redistribute(double difference, double largest) {
    constexpr double p_c = 0.4, p_t = 0.95;
    const double knee = p_c * largest;
    if (difference < knee) return p_t / knee * difference;
    return p_t + (difference - knee) / (largest - knee) * (1 - p_t);
}

/// A Gaussian of the contrast sensitivity: a √(π/b) exp(−π² d² / b), d in degrees.
struct Gaussian {
    double a, b;
};

/// Table 1 of the paper.
constexpr Gaussian achromatic{1, 0.0047}, red_green{1, 0.0053};
constexpr Gaussian blue_yellow[] = {{34.1, 0.04}, {13.5, 0.025}};

Kernel gaussian_kernel(double b, int radius, double pixels_per_degree) {
    Kernel kernel;
    for (int x = -radius; x <= radius; ++x) {
        kernel.push_back(
            static_cast<float>(std::exp(-sqr(std::numbers::pi * x / pixels_per_degree) / b)));
    }
    return kernel;
}

double sum_of(const Kernel& kernel) {
    double sum = 0;
    for (const float k : kernel) sum += double{k};
    return sum;
}

void scale(Kernel& kernel, double factor) {
    for (float& k : kernel) k = static_cast<float>(double{k} * factor);
}

/// Convolves rows with one kernel and columns with another; the border is repeated outwards.
/// Innermost loops run along rows, so that they stream through memory.
class Convolution {
public:
    Convolution(int width, int height) : width_(width), height_(height), rows_(count()) {}

    Channel operator()(const Channel& in, const Kernel& horizontal, const Kernel& vertical) {
        Channel out(count());
        for (int y = 0; y < height_; ++y) filter_row(&in[row(y)], horizontal, &rows_[row(y)]);
        const int radius = static_cast<int>(vertical.size() / 2);
        for (int y = 0; y < height_; ++y) {
            for (int k = -radius; k <= radius; ++k) {
                const float* source = &rows_[row(std::clamp(y + k, 0, height_ - 1))];
                add(source, vertical[static_cast<std::size_t>(k + radius)], &out[row(y)]);
            }
        }
        return out;
    }

private:
    std::size_t count() const { return std::size_t(width_) * std::size_t(height_); }
    std::size_t row(int y) const { return std::size_t(y) * std::size_t(width_); }

    void filter_row(const float* in, const Kernel& kernel, float* out) {
        const std::size_t radius = kernel.size() / 2;
        padded_.assign(radius, in[0]);
        padded_.insert(padded_.end(), in, in + width_);
        padded_.insert(padded_.end(), radius, in[width_ - 1]);
        std::fill(out, out + width_, 0.0f);
        for (std::size_t k = 0; k < kernel.size(); ++k) add(&padded_[k], kernel[k], out);
    }

    void add(const float* in, float weight, float* out) const {
        for (int x = 0; x < width_; ++x) out[x] += weight * in[x];
    }

    int width_, height_;
    Channel rows_, padded_;
};

/// An image as the eye takes it in: opponent colours, filtered colours, features.
struct Percept {
    std::vector<Vector3d> lab;  ///< filtered, Hunt-adjusted
    Channel edges, points;      ///< magnitudes
};

/// Filters by the contrast sensitivity of each opponent channel (section 4.1).
std::vector<Vector3d> filtered_lab(Convolution& convolve, const std::array<Channel, 3>& opponent,
                                   double pixels_per_degree) {
    // Three standard deviations of the widest kernel, which is one of blue-yellow.
    const double widest = std::sqrt(blue_yellow[0].b / (2 * sqr(std::numbers::pi)));
    const int radius = static_cast<int>(std::ceil(3 * widest * pixels_per_degree));
    const auto kernel = [&](double b) { return gaussian_kernel(b, radius, pixels_per_degree); };

    std::array<Channel, 3> filtered;
    const double single[] = {achromatic.b, red_green.b};
    for (std::size_t c = 0; c < 2; ++c) {
        Kernel k = kernel(single[c]);
        scale(k, 1 / sum_of(k));
        filtered[c] = convolve(opponent[c], k, k);
    }
    // The sum of two Gaussians is not separable, but each of them is.
    double total = 0;
    for (const Gaussian& g : blue_yellow) {
        total += g.a * std::sqrt(std::numbers::pi / g.b) * sqr(sum_of(kernel(g.b)));
    }
    filtered[2].resize(opponent[2].size());
    for (const Gaussian& g : blue_yellow) {
        const Kernel k = kernel(g.b);
        Kernel weighted = k;
        scale(weighted, g.a * std::sqrt(std::numbers::pi / g.b) / total);
        const Channel part = convolve(opponent[2], weighted, k);
        for (std::size_t i = 0; i < part.size(); ++i) filtered[2][i] += part[i];
    }

    std::vector<Vector3d> lab(opponent[0].size());
    for (std::size_t i = 0; i < lab.size(); ++i) {
        const Vector3d value(double{filtered[0][i]}, double{filtered[1][i]},
                             double{filtered[2][i]});
        const Vector3d rgb = glm::clamp(rgb_from_ycxcz(value), Vector3d(0), Vector3d(1));
        lab[i] = hunt_lab_from_rgb(rgb);
    }
    return lab;
}

/// Derivatives of a Gaussian that detect edges (first) and points (second), and the Gaussian
/// across; positive and negative weights sum to 1 and −1 (section 4.2).
struct FeatureKernels {
    Kernel across, edge, point;

    explicit FeatureKernels(double pixels_per_degree) {
        constexpr double feature_width = 0.082;  // degrees
        const double deviation = 0.5 * feature_width * pixels_per_degree;
        const int radius = static_cast<int>(std::ceil(3 * deviation));
        for (int x = -radius; x <= radius; ++x) {
            const double t = x / deviation, g = std::exp(-0.5 * t * t);
            across.push_back(static_cast<float>(g));
            edge.push_back(static_cast<float>(-x * g));
            point.push_back(static_cast<float>((t * t - 1) * g));
        }
        scale(across, 1 / sum_of(across));
        balance(edge);
        balance(point);
    }

private:
    static void balance(Kernel& kernel) {
        double positive = 0, negative = 0;
        for (const float k : kernel) (k > 0 ? positive : negative) += std::abs(double{k});
        for (float& k : kernel) {
            k = static_cast<float>(double{k} / (k > 0 ? positive : negative));
        }
    }
};

Channel magnitude(Convolution& convolve, const Channel& in, const Kernel& derivative,
                  const Kernel& across) {
    Channel x = convolve(in, derivative, across);
    const Channel y = convolve(in, across, derivative);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sqrt(sqr(x[i]) + sqr(y[i]));
    return x;
}

Percept perceive(const Image& image, const std::vector<bool>& finite, double gain,
                 double pixels_per_degree) {
    std::array<Channel, 3> opponent;
    for (Channel& channel : opponent) channel.resize(image.pixel_count());
    Channel lightness(image.pixel_count());
    for (std::size_t i = 0; i < lightness.size(); ++i) {
        const Vector3d rgb = finite[i] ? Vector3d(image.rgb(i)) * gain : Vector3d(0);
        const Vector3d value = ycxcz_from_rgb(glm::clamp(rgb, Vector3d(0), Vector3d(1)));
        for (std::size_t c = 0; c < 3; ++c) {
            opponent[c][i] = static_cast<float>(value[static_cast<int>(c)]);
        }
        lightness[i] = static_cast<float>((value.x + 16) / 116);
    }
    Convolution convolve(image.width, image.height);
    const FeatureKernels kernels(pixels_per_degree);
    return {.lab = filtered_lab(convolve, opponent, pixels_per_degree),
            .edges = magnitude(convolve, lightness, kernels.edge, kernels.across),
            .points = magnitude(convolve, lightness, kernels.point, kernels.across)};
}

/// The error of one pixel: its colour difference, amplified by its feature difference.
double pixel_error(const Percept& a, const Percept& b, std::size_t i, double largest) {
    constexpr double q_c = 0.7, q_f = 0.5;
    const double color = redistribute(std::pow(hyab(a.lab[i], b.lab[i]), q_c), largest);
    const double edge = std::abs(double{a.edges[i]} - double{b.edges[i]});
    const double point = std::abs(double{a.points[i]} - double{b.points[i]});
    const double feature = std::pow(std::max(edge, point) / std::sqrt(2.0), q_f);
    return std::pow(color, 1 - feature);
}

}  // namespace

Flip flip(const Image& image, const Image& reference, double pixels_per_degree, double exposure) {
    if (image.width != reference.width || image.height != reference.height) {
        throw Error(fmt::format(
            "images of {} x {} and {} x {} pixels cannot be compared; render both at one size",
            image.width, image.height, reference.width, reference.height));
    }
    if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000)) {
        throw Error(fmt::format("{} pixels per degree; 1 to 1000 are possible, 67 is usual",
                                pixels_per_degree));
    }
    Flip result{.map = Image(image.width, image.height, {"Y"})};
    const std::size_t count = image.pixel_count();
    std::vector<bool> finite_image(count), finite_reference(count);
    for (std::size_t i = 0; i < count; ++i) {
        finite_image[i] = is_finite(image.rgb(i));
        finite_reference[i] = is_finite(reference.rgb(i));
    }
    const double gain = std::exp2(exposure);
    const Percept a = perceive(image, finite_image, gain, pixels_per_degree);
    const Percept b = perceive(reference, finite_reference, gain, pixels_per_degree);

    // The largest difference between two colours of the display is that of green and blue.
    const double largest =
        std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), 0.7);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        double error = 1;
        if (finite_image[i] && finite_reference[i]) {
            error = std::clamp(pixel_error(a, b, i, largest), 0.0, 1.0);
            sum += error;
        } else {
            ++result.non_finite;
        }
        result.map.pixels[i] = static_cast<float>(error);
    }
    const std::size_t finite = count - result.non_finite;
    result.mean = finite > 0 ? sum / static_cast<double>(finite) : 1;
    result.mean_all = (sum + static_cast<double>(result.non_finite)) / static_cast<double>(count);
    return result;
}

}  // namespace lucerna
