// SPDX-License-Identifier: Apache-2.0
#include "plugins/bsdfs/measured_material.h"

#include "core/base/error.h"
#include "core/image/spectrum.h"
#include "core/math/frame.h"
#include "plugins/bsdfs/tensor_file.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

constexpr double pi_d = std::numbers::pi;
/// The smallest u of θ in the square: nearer to the normal, a direction of floats has no angle.
constexpr double least_u = 0x1p-13;

double theta_of(Vector3d w) { return std::atan2(std::hypot(w.x, w.y), w.z); }
double phi_of(Vector3d w) { return w.x == 0 && w.y == 0 ? 0.0 : std::atan2(w.y, w.x); }

Vector2d square_point(double theta, double phi) {
    const double turn = (phi + pi_d) / (2 * pi_d);
    return {std::sqrt(std::max(theta, 0.0) * (2 / pi_d)), turn - std::floor(turn)};
}

Vector3d direction_at(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Solid angle per area of the square at the u of θ.
double solid_angle_of_area(double u) { return 2 * sqr(pi_d) * u * std::sin(0.5 * pi_d * sqr(u)); }

void require_rising(const TensorFile& file, const char* name, const std::vector<float>& numbers) {
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        if (numbers[i] > numbers[i - 1]) continue;
        file.fail(fmt::format("the numbers of field \"{}\" must rise, but {} follows {}", name,
                              numbers[i], numbers[i - 1]));
    }
}

std::vector<float> non_negative_floats(const TensorFile& file, const char* name,
                                       const std::vector<std::uint64_t>& shape) {
    std::vector<float> numbers = file.floats(name, shape);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] >= 0) continue;
        file.fail(fmt::format("number {} of field \"{}\" is negative: {}", i, name, numbers[i]));
    }
    return numbers;
}

/// The last two dimensions of a field of the type float32.
TableShape table_shape(const TensorFile& file, const char* name,
                       const std::vector<std::uint64_t>& shape) {
    const auto& it = file.field(name, TensorField::Type::float32, shape).shape;
    return {.width = it[it.size() - 1], .height = it[it.size() - 2]};
}

}  // namespace

MeasuredMaterial::MeasuredMaterial(std::span<const std::uint8_t> bytes, const std::string& name) {
    read_tables(TensorFile(bytes, name));
}

void MeasuredMaterial::read_tables(const TensorFile& file) {
    constexpr auto any = TensorFile::any;
    const auto numbers_of = [&](const char* name) {
        const std::size_t count = file.one_dimension(name);
        std::vector<float> numbers = file.floats(name, {count});
        require_rising(file, name, numbers);
        return numbers;
    };
    parameters_ = {.down = numbers_of("phi_i"), .across = numbers_of("theta_i")};
    const std::uint64_t phis = parameters_.down.size(), thetas = parameters_.across.size();
    if (!isotropic()) {
        const auto range = static_cast<double>(parameters_.down.back() - parameters_.down.front());
        symmetry_ = static_cast<int>(std::lround(std::min(2 * pi_d / range, 100.0)));
        if (symmetry_ != 1 && symmetry_ != 2 && symmetry_ != 4) {
            file.fail(
                fmt::format("field \"phi_i\" covers {:.4g}°; it must be a whole turn, a half "
                            "or a quarter",
                            range * 180 / pi_d));
        }
    }

    normals_shape_ = table_shape(file, "ndf", {any, any});
    normals_ = non_negative_floats(file, "ndf", {any, any});
    area_shape_ = table_shape(file, "sigma", {any, any});
    area_ = non_negative_floats(file, "sigma", {any, any});
    const auto warp = [&](const char* name) {
        const std::vector<std::uint64_t> shape{phis, thetas, any, any};
        const TableShape table = table_shape(file, name, shape);
        BilinearWarp result(non_negative_floats(file, name, shape), table);
        for (std::size_t k = 0; k < parameters_.count(); ++k) {
            if (!result.is_zero(k)) continue;
            file.fail(
                fmt::format("all numbers of field \"{}\" are zero for phi_i {} and theta_i "
                            "{}",
                            name, parameters_.down[k / thetas], parameters_.across[k % thetas]));
        }
        return result;
    };
    visible_normals_ = warp("vndf");
    luminance_ = warp("luminance");
    jacobian_ = file.field("jacobian", TensorField::Type::uint8, {1}).bytes[0] != 0;
    colors_ = read_colors(file, luminance_.shape());
}

std::vector<Color> MeasuredMaterial::read_colors(const TensorFile& file, TableShape shape) const {
    const std::uint64_t phis = parameters_.down.size(), thetas = parameters_.across.size();
    std::vector<ColorD> channels{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const bool has_rgb = file.has("rgb");
    if (!has_rgb) {
        const std::size_t count = file.one_dimension("wavelengths");
        const std::vector<float> wavelengths = file.floats("wavelengths", {count});
        require_rising(file, "wavelengths", wavelengths);
        channels = rgb_of_reflectances({wavelengths.begin(), wavelengths.end()});
    }
    const std::vector<float> values = file.floats(
        has_rgb ? "rgb" : "spectra", {phis, thetas, channels.size(), shape.height, shape.width});
    std::vector<Color> colors(parameters_.count() * shape.count());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const std::size_t table = i / shape.count(), node = i % shape.count();
        ColorD sum(0);
        for (std::size_t k = 0; k < channels.size(); ++k) {
            const float value = values[(table * channels.size() + k) * shape.count() + node];
            sum += static_cast<double>(value) * channels[k];
        }
        colors[i] = Color(glm::max(sum, ColorD(0)));
    }
    return colors;
}

/// Turns or mirrors directions into the part of a turn that was measured, which begins at φ = −π,
/// and back.
struct MeasuredMaterial::Fold {
    Fold(int symmetry, Vector3d wi)
        : x(symmetry == 1   ? 1.0
            : symmetry == 2 ? opposite(wi.y)
                            : opposite(wi.x)),
          y(symmetry == 1 ? 1.0 : opposite(wi.y)) {}

    Vector3d operator()(Vector3d w) const { return {x * w.x, y * w.y, w.z}; }

    static double opposite(double coordinate) { return coordinate > 0 ? -1.0 : 1.0; }

    double x, y;
};

TableMix MeasuredMaterial::mix(Vector3 wi) const {
    const Vector3d w = Fold(symmetry_, Vector3d(wi))(Vector3d(wi));
    return parameters_.mix(phi_of(w), theta_of(w));
}

Vector3 MeasuredMaterial::direction(std::size_t table) const {
    const std::size_t thetas = parameters_.across.size();
    return Vector3(direction_at(static_cast<double>(parameters_.across[table % thetas]),
                                static_cast<double>(parameters_.down[table / thetas])));
}

MeasuredMaterial::Value MeasuredMaterial::evaluate(Vector3 wi_, Vector3 wo_) const {
    const Fold fold(symmetry_, Vector3d(wi_));
    const Vector3d wi = fold(Vector3d(wi_)), wo = fold(Vector3d(wo_)), sum = wi + wo;
    const double length = glm::length(sum);
    if (!(length > 0)) return {};
    const Vector3d m = sum / length;
    const double theta_i = theta_of(wi), phi_i = phi_of(wi);
    Vector2d u_m = square_point(theta_of(m), isotropic() ? phi_of(m) - phi_i : phi_of(m));
    u_m.x = std::clamp(u_m.x, least_u, 1.0);

    const TableMix mix = parameters_.mix(phi_i, theta_i);
    const BilinearWarp::Inverse normal = visible_normals_.invert(mix, u_m);
    const double density = luminance_.invert(mix, normal.u).pdf * normal.pdf;
    Value value;
    value.pdf = density / (solid_angle_of_area(u_m.x) * 4 * glm::dot(wi, m));
    if (!(value.pdf > 0) || !std::isfinite(value.pdf)) return {};
    ColorD f_cos = interpolate<ColorD>(
        luminance_.shape(), mix, normal.u, [&](std::size_t table, std::size_t node) {
            return ColorD(colors_[table * luminance_.shape().count() + node]);
        });
    if (jacobian_) {
        const TableMix one{.count = 1, .table = {0}, .weight = {1}};
        const auto number_of = [](const std::vector<float>& numbers) {
            return
                [&](std::size_t, std::size_t node) { return static_cast<double>(numbers[node]); };
        };
        const double area =
            interpolate<double>(area_shape_, one, square_point(theta_i, phi_i), number_of(area_));
        if (!(area > 0)) return {};
        f_cos *= interpolate<double>(normals_shape_, one, u_m, number_of(normals_)) / (4 * area);
    }
    value.f_cos = Color(f_cos);
    return value;
}

Vector3 MeasuredMaterial::sample(Vector3 wi_, Vector2 u) const {
    const Fold fold(symmetry_, Vector3d(wi_));
    const Vector3d wi = fold(Vector3d(wi_));
    const double phi_i = phi_of(wi);
    const TableMix mix = parameters_.mix(phi_i, theta_of(wi));
    const Vector2d u_m = visible_normals_.sample(mix, luminance_.sample(mix, Vector2d(u)));
    const double phi = (2 * u_m.y - 1) * pi_d;
    const Vector3d m = direction_at(0.5 * pi_d * sqr(u_m.x), isotropic() ? phi + phi_i : phi);
    return Vector3(fold(2 * glm::dot(wi, m) * m - wi));
}

}  // namespace lucerna
