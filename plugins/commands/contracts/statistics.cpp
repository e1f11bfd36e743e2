// SPDX-License-Identifier: Apache-2.0
/// Statistical tests: distributions, intervals, histograms.
#include "plugins/commands/contracts/statistics.h"

#include "core/math/quadrature.h"

#include <fmt/format.h>

#include <numeric>

namespace lucerna {
namespace {

/// Upper regularised incomplete gamma function Q(a, x): series below a + 1, Lentz's continued
/// fraction above (Press et al. 2007, "Numerical Recipes", 6.2).
double gamma_q(double a, double x) {
    if (x <= 0) return 1;
    const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > sum * 1e-16; ++n) sum += term *= x / n;
        return 1 - front * sum;
    }
    constexpr double tiny = 1e-300;
    double b = x + 1 - a, c = 1 / tiny, d = 1 / b, h = d;
    for (int i = 1; i < 100000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (std::abs(an * d + b) < tiny ? tiny : an * d + b);
        c = std::abs(b + an / c) < tiny ? tiny : b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return front * h;
}

/// Continued fraction of the incomplete beta function (ibid., 6.4).
double beta_fraction(double a, double b, double x) {
    constexpr double tiny = 1e-300;
    const auto guarded = [](double v) { return std::abs(v) < tiny ? tiny : v; };
    double c = 1, d = 1 / guarded(1 - (a + b) * x / (a + 1)), h = d;
    for (int m = 1; m < 100000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        for (const double term : {even, odd}) {
            d = 1 / guarded(1 + term * d);
            c = guarded(1 + term / c);
            h *= d * c;
        }
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return h;
}

/// Regularised incomplete beta function.
double beta_i(double a, double b, double x) {
    if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
    const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                  a * std::log(x) + b * std::log1p(-x));
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// The x in [low, high] where the falling function `f` passes `target`.
template <typename F>
double bisect(double low, double high, double target, F f) {
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        (f(middle) > target ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

using Function2 = std::function<double(double, double)>;

double gauss_2d(const Function2& f, double x0, double x1, double y0, double y1) {
    static const GaussLegendre rule(5);
    return rule.integrate(y0, y1, [&](double y) {
        return rule.integrate(x0, x1, [&](double x) { return f(x, y); });
    });
}

double refine(const Function2& f, double x0, double x1, double y0, double y1, double whole,
              double tolerance, int depth) {
    const double x = 0.5 * (x0 + x1), y = 0.5 * (y0 + y1);
    const double parts[] = {gauss_2d(f, x0, x, y0, y), gauss_2d(f, x, x1, y0, y),
                            gauss_2d(f, x0, x, y, y1), gauss_2d(f, x, x1, y, y1)};
    const double sum = parts[0] + parts[1] + parts[2] + parts[3];
    if (depth == 0 || std::abs(sum - whole) <= tolerance) return sum;
    // The error of quarters adds up like noise, so each may have half of it, not a quarter.
    const double next = 0.5 * tolerance;
    return refine(f, x0, x, y0, y, parts[0], next, depth - 1) +
           refine(f, x, x1, y0, y, parts[1], next, depth - 1) +
           refine(f, x0, x, y, y1, parts[2], next, depth - 1) +
           refine(f, x, x1, y, y1, parts[3], next, depth - 1);
}

struct Cell {
    double observed = 0, expected = 0;
    void add(const Cell& other) {
        observed += other.observed;
        expected += other.expected;
    }
};

/// A function of direction as one of θ and φ, times sin θ.
Function2 in_angles(const std::function<double(Vector3)>& f) {
    return [f](double phi, double theta) {
        const double s = std::sin(theta);
        const Vector3 w(static_cast<float>(s * std::cos(phi)),
                        static_cast<float>(s * std::sin(phi)), static_cast<float>(std::cos(theta)));
        return s * f(w);
    };
}

}  // namespace

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double normal_quantile(double p) {
    return -bisect(-40, 40, p, [](double x) { return normal_cdf(-x); });
}

double chi_square_p_value(double statistic, double dof) { return gamma_q(dof / 2, statistic / 2); }

double student_p_value(double t, double dof) { return beta_i(dof / 2, 0.5, dof / (dof + t * t)); }

double student_quantile(double two_sided_p, double dof) {
    return bisect(0, 1e6, two_sided_p, [dof](double t) { return student_p_value(t, dof); });
}

double sidak(double family, double tests) { return -std::expm1(std::log1p(-family) / tests); }

void RunningStatistics::add(double x) {
    ++count_;
    const double delta = x - mean_;
    mean_ += delta / count_;
    sum_squares_ += delta * (x - mean_);
}

void RunningStatistics::add(const RunningStatistics& other) {
    if (other.count_ == 0) return;
    const double delta = other.mean_ - mean_, total = count_ + other.count_;
    mean_ += delta * other.count_ / total;
    sum_squares_ += other.sum_squares_ + delta * delta * count_ * other.count_ / total;
    count_ = total;
}

Interval RunningStatistics::confidence(double level) const {
    if (count_ < 2) return {-HUGE_VAL, HUGE_VAL};
    const double half = student_quantile(1 - level, count_ - 1) * standard_error();
    return {mean_ - half, mean_ + half};
}

Judgement mean_is(const RunningStatistics& x, double reference, double tolerance) {
    const double off = std::max(std::abs(x.mean() - reference) - tolerance, 0.0);
    if (x.standard_error() == 0) {
        return {off == 0 ? 1.0 : 0.0, fmt::format("{:.6g}, expected {:.6g}", x.mean(), reference)};
    }
    const double t = off / x.standard_error();
    return {
        student_p_value(t, x.count() - 1),
        fmt::format("{:.6g} ± {:.1g}, expected {:.6g}", x.mean(), x.standard_error(), reference)};
}

Judgement means_agree(const RunningStatistics& x, const RunningStatistics& y, double tolerance) {
    const double off = std::max(std::abs(x.mean() - y.mean()) - tolerance, 0.0);
    const double error = std::hypot(x.standard_error(), y.standard_error());
    const std::string figures = fmt::format("{:.6g} ± {:.1g} and {:.6g} ± {:.1g}", x.mean(),
                                            x.standard_error(), y.mean(), y.standard_error());
    if (error == 0) return {off == 0 ? 1.0 : 0.0, figures};
    return {2 * normal_cdf(-off / error), figures};
}

Judgement chi_square(std::span<const double> observed, std::span<const double> expected,
                     double constraints) {
    std::vector<Cell> cells;
    Cell pool;
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] <= 0 && observed[i] > 0) {
            return {
                0, fmt::format("{} samples in cell {}, where the density is zero", observed[i], i)};
        }
        Cell cell{observed[i], expected[i]};
        if (cell.expected < 5) {
            pool.add(cell);
            cell = pool;
        }
        if (cell.expected < 5) continue;
        cells.push_back(cell);
        if (expected[i] < 5) pool = {};
    }
    if (!cells.empty()) cells.back().add(pool);

    double statistic = 0;
    for (const Cell& cell : cells) statistic += sqr(cell.observed - cell.expected) / cell.expected;
    const double dof = static_cast<double>(cells.size()) - constraints;
    if (dof < 1) return {1, "too few cells to test"};
    return {chi_square_p_value(statistic, dof),
            fmt::format("χ² = {:.1f} with {} degrees of freedom", statistic, dof)};
}

SphereCounts::SphereCounts(const std::function<std::optional<Vector3>(Vector2)>& sample,
                           const std::function<double(Vector3)>& pdf, const SphereGrid& grid)
    : observed_(static_cast<std::size_t>(grid.theta_cells * grid.phi_cells) + 1),
      expected_(observed_.size()),
      samples_(grid.samples) {
    const double d_theta = std::numbers::pi / grid.theta_cells;
    const double d_phi = 2 * std::numbers::pi / grid.phi_cells;
    Rng rng(grid.seed);
    for (int i = 0; i < grid.samples; ++i) {
        const Vector2 u = rng.next_float2();
        const std::optional<Vector3> w = sample(u);
        if (!w) {
            ++observed_.back();
            continue;
        }
        if (!is_finite(*w)) {
            if (fault_.empty()) fault_ = fmt::format("not finite at u = {}, {}", u.x, u.y);
            continue;
        }
        const double theta = std::atan2(std::hypot(w->x, w->y), w->z);
        const double phi = std::atan2(w->y, w->x) + (w->y < 0 ? 2 * std::numbers::pi : 0);
        const int row = std::min(static_cast<int>(theta / d_theta), grid.theta_cells - 1);
        const int column = std::min(static_cast<int>(phi / d_phi), grid.phi_cells - 1);
        ++observed_[static_cast<std::size_t>(row * grid.phi_cells + column)];
    }

    const Function2 density = in_angles(pdf);
    for (int cell = 0; cell < grid.theta_cells * grid.phi_cells; ++cell) {
        const double theta = cell / grid.phi_cells * d_theta;
        const double phi = cell % grid.phi_cells * d_phi;
        const double p = integrate_2d(density, phi, phi + d_phi, theta, theta + d_theta, 1e-7);
        expected_[static_cast<std::size_t>(cell)] = p * samples_;
    }
    integral_ = std::accumulate(expected_.begin(), expected_.end(), 0.0) / samples_;
    // Integration errors must not look like a tiny chance to fail.
    if (observed_.back() > 0 || integral_ < 1 - 1e-4) {
        expected_.back() = std::max(samples_ * (1 - integral_), 0.0);
    }
}

Judgement SphereCounts::normalization() const {
    const double drawn = 1 - observed_.back() / samples_;
    const std::string figures = fmt::format(
        "the density integrates to {:.5f}, {:.5f} of the draws are directions", integral_, drawn);
    if (integral_ > 1 + 1e-3) return {0, figures};
    const double p = std::clamp(integral_, 0.0, 1.0);
    const double off = std::max(std::abs(drawn - p) - 1e-4, 0.0);
    const double error = std::sqrt(p * (1 - p) / samples_);
    if (off == 0 || error == 0) return {off == 0 ? 1.0 : 0.0, figures};
    return {2 * normal_cdf(-off / error), figures};
}

Judgement SphereCounts::agreement() const {
    if (!fault_.empty()) return {0, fault_};
    if (integral_ > 1 + 1e-3) return {0, fmt::format("the pdf integrates to {}", integral_)};
    return chi_square(observed_, expected_);
}

double integrate_2d(const Function2& f, double x0, double x1, double y0, double y1,
                    double tolerance) {
    return refine(f, x0, x1, y0, y1, gauss_2d(f, x0, x1, y0, y1), tolerance, 12);
}

double integrate_sphere(const std::function<double(Vector3)>& f, double tolerance) {
    // Strips, so that narrow peaks at the poles and the horizon are not stepped over.
    constexpr int strips = 16;
    constexpr double step = std::numbers::pi / strips;
    const Function2 density = in_angles(f);
    double sum = 0;
    for (int row = 0; row < strips; ++row) {
        for (int column = 0; column < 2 * strips; ++column) {
            sum += integrate_2d(density, column * step, (column + 1) * step, row * step,
                                (row + 1) * step, tolerance / strips);
        }
    }
    return sum;
}

}  // namespace lucerna
