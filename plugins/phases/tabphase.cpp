// SPDX-License-Identifier: Apache-2.0
/// tabphase: a phase function from a table over the cosine of the angle by which light turns.
///
/// The values stand at equal steps of cos θ from −1, backwards, to 1, forwards, and are joined by
/// straight lines. They are scaled so that the integral over all directions is 1.
#include "core/description/values.h"
#include "plugins/phases/around.h"

#include <algorithm>
#include <vector>

namespace lucerna {
namespace {

class TabulatedPhase final : public Phase {
public:
    explicit TabulatedPhase(const Params& params) {
        const std::string text =
            params.string("values", "1, 1", "numbers between commas or spaces, two or more");
        try {
            values_ = parse_numbers(text);
        } catch (const Error& e) {
            params.error("values", e.what());
        }
        if (values_.empty()) values_ = {0};
        const double most = *std::max_element(values_.begin(), values_.end());
        const double least = *std::min_element(values_.begin(), values_.end());
        if (values_.size() < 2 || !(least >= 0) || !(most > 0)) {
            params.error("values", wanted);
            values_ = {1, 1};
        }
        step_ = 2 / static_cast<double>(values_.size() - 1);
        double until = 0;
        for (std::size_t i = 0; i < values_.size(); ++i) {
            if (i > 0) until += 0.5 * step_ * (values_[i - 1] + values_[i]);
            sums_.push_back(until);
        }
        for (double& v : values_) v /= until;
        for (double& sum : sums_) sum /= until;
    }

    PhaseValue evaluate(Vector3, Vector3 wo, Vector3 wi) const override {
        const float f = value(static_cast<double>(scattering_cosine(wo, wi)));
        return {.f = f, .pdf = f};
    }

    PhaseSample sample(Vector3, Vector3 wo, float, Vector2 u) const override {
        const double target = static_cast<double>(u.x) * sums_.back();
        const auto above = std::upper_bound(sums_.begin() + 1, sums_.end() - 1, target);
        const auto i = static_cast<std::size_t>(above - sums_.begin()) - 1;
        // The root of a t + (b − a) t² / 2 = rest, in the form that cancels nothing.
        const double a = values_[i], b = values_[i + 1], rest = (target - sums_[i]) / step_;
        const double root = std::sqrt(std::max(a * a + 2 * (b - a) * rest, 0.0));
        const double t = a + root > 0 ? std::clamp(2 * rest / (a + root), 0.0, 1.0) : 0.0;
        const double cosine = -1 + step_ * (static_cast<double>(i) + t);
        const Vector3 wi = turned(wo, std::clamp(cosine, -1.0, 1.0), u.y);
        return {.wi = wi, .weight = 1, .pdf = value(cosine)};
    }

private:
    static constexpr const char* wanted =
        "\"values\" must be two or more numbers that are not negative, and not all of them zero";

    float value(double cosine) const {
        const double place = (cosine + 1) / step_;
        const auto i = std::min(static_cast<std::size_t>(std::max(place, 0.0)), values_.size() - 2);
        const double t = place - static_cast<double>(i);
        const double density = values_[i] + t * (values_[i + 1] - values_[i]);
        return static_cast<float>(std::max(density, 0.0) / (2 * std::numbers::pi));
    }

    std::vector<double> values_;  ///< densities of cos θ
    std::vector<double> sums_;    ///< of the area until each value
    double step_ = 1;             ///< of cos θ
};

}  // namespace

const PluginInfo plugin = describe<TabulatedPhase>("a table over the cosine of the angle");

}  // namespace lucerna
