// SPDX-License-Identifier: Apache-2.0
/// Radiance of a clear sky and of the sun (Hošek and Wilkie 2012, "An Analytic Model for Full
/// Spectral Sky-Dome Radiance", with the coefficients of their RGB version; 2013, "Adding a Solar
/// Radiance Function to the Hošek-Wilkie Skylight Model"). The unit is that of Mitsuba's `sunsky`:
/// luminance in cd/m² is 683 · 106.86 times that of the colour.
#pragma once

#include "plugins/emitters/sky_tables.h"

#include "core/math/vector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lucerna {

class SkyModel {
public:
    SkyModel() = default;
    /// turbidity in [1, 10]; `elevation` of the sun above the horizon [rad]; below, all is dark.
    SkyModel(double turbidity, Color albedo, double elevation) {
        if (!(elevation >= 0)) return;
        const double x = std::cbrt(elevation * 2 / std::numbers::pi);
        for (std::size_t c = 0; c < 3; ++c) {
            const double ground = static_cast<double>(albedo[static_cast<int>(c)]);
            for (std::size_t k = 0; k < 9; ++k) {
                coefficients_[c][k] = static_cast<float>(
                    fitted(sky_tables::coefficients, 9, c, k, turbidity, ground, x));
            }
            radiance_[c] = static_cast<float>(
                fitted(sky_tables::radiances, 1, c, 0, turbidity, ground, x) / cie_y_integral);
        }
        sun_ = sun_at(turbidity, x);
    }

    /// Radiance of the sky in a direction above the horizon; γ is its angle to the sun.
    Color sky(float cos_theta, float cos_gamma) const {
        const float gamma = std::acos(std::clamp(cos_gamma, -1.0f, 1.0f));
        Color result(0);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& [A, B, C, D, E, F, G, H, I] = coefficients_[c];
            const float cos2 = cos_gamma * cos_gamma;
            const float base = 1 + I * I - 2 * I * cos_gamma;
            const float mie = (1 + cos2) / (base * std::sqrt(base));
            const float value = (1 + A * std::exp(B / (cos_theta + 0.01f))) *
                                (C + D * std::exp(E * gamma) + F * cos2 + G * mie +
                                 H * std::sqrt(std::max(cos_theta, 0.0f)));
            result[static_cast<int>(c)] = std::max(value * radiance_[c], 0.0f);
        }
        return result;
    }

    /// Mean radiance of the sun's disk as it is seen from the Earth, 0.5358° wide.
    Color sun() const { return sun_; }

private:
    static constexpr double cie_y_integral = 106.856895;  // [nm]

    /// A number of the table: linear in turbidity and albedo, a Bézier curve of degree 5 in x.
    static double fitted(const float* table, std::size_t numbers, std::size_t channel,
                         std::size_t number, double turbidity, double albedo, double x) {
        const auto at = [&](std::size_t t, std::size_t a, std::size_t point) {
            return static_cast<double>(
                table[(((t * 2 + a) * 6 + point) * 3 + channel) * numbers + number]);
        };
        const auto [low, part] = between(turbidity);
        constexpr double binomial[] = {1, 5, 10, 10, 5, 1};
        double sum = 0;
        for (std::size_t k = 0; k < 6; ++k) {
            const auto of = [&](std::size_t t) {
                return std::lerp(at(t, 0, k), at(t, 1, k), albedo);
            };
            const auto power = static_cast<double>(k);
            sum += std::lerp(of(low), of(low + 1), part) * binomial[k] * std::pow(x, power) *
                   std::pow(1 - x, 5 - power);
        }
        return sum;
    }

    static Color sun_at(double turbidity, double x) {
        const auto [low, part] = between(turbidity);
        const std::size_t i = std::min(static_cast<std::size_t>(x * 32), std::size_t{31});
        const double along = x * 32 - static_cast<double>(i);
        Color result(0);
        for (std::size_t c = 0; c < 3; ++c) {
            const auto of = [&](std::size_t t) {
                const float* const row = sky_tables::sun + (t * 33 + i) * 3 + c;
                return std::lerp(static_cast<double>(row[0]), static_cast<double>(row[3]), along);
            };
            result[static_cast<int>(c)] = static_cast<float>(std::lerp(of(low), of(low + 1), part));
        }
        return result;
    }

    /// The row of a turbidity, the lower one of two, and how far it is from there to the next.
    static std::pair<std::size_t, double> between(double turbidity) {
        const std::size_t low = std::min(static_cast<std::size_t>(turbidity - 1), std::size_t{8});
        return {low, turbidity - 1 - static_cast<double>(low)};
    }

    std::array<std::array<float, 9>, 3> coefficients_{};
    std::array<float, 3> radiance_{};
    Color sun_{0};
};

}  // namespace lucerna
