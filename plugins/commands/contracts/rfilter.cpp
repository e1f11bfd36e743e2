// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/rfilter.h"

#include "core/render/reconstruction_filter.h"

#include <fmt/format.h>

namespace lucerna::contracts {

double integral(const RFilter& filter) {
    constexpr int n = 200000;
    const double r = static_cast<double>(filter.radius());
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const auto x = static_cast<float>((2 * (i + 0.5) / n - 1) * r);
        sum += static_cast<double>(filter.evaluate(x));
    }
    return sum * 2 * r / n;
}

Evidence rfilter_shape(const RFilter& filter) {
    Evidence evidence("even, and zero beyond the radius");
    const float r = filter.radius();
    if (!evidence.require(r > 0 && std::isfinite(r),
                          [&] { return fmt::format("the radius is {}", r); })) {
        return evidence;
    }
    for (int i = 0; i <= 1000; ++i) {
        const float x = r * static_cast<float>(i) / 1000, f = filter.evaluate(x);
        evidence.require(std::isfinite(f), [&] { return fmt::format("f({}) = {}", x, f); });
        evidence.require(f == filter.evaluate(-x), [&] {
            return fmt::format("f({}) = {}, f(-{}) = {}", x, f, x, filter.evaluate(-x));
        });
        evidence.require(f <= filter.evaluate(0), [&] {
            return fmt::format("f({}) = {} is more than f(0) = {}", x, f, filter.evaluate(0));
        });
    }
    for (const float x : {1.0001f * r, 1.5f * r, 100 * r}) {
        for (const float side : {x, -x}) {
            evidence.require(filter.evaluate(side) == 0, [&] {
                return fmt::format("f({}) = {}, and the radius is {}", side, filter.evaluate(side),
                                   r);
            });
        }
    }
    return evidence;
}

Evidence rfilter_integral(const RFilter& filter) {
    Evidence evidence("the integral is positive");
    const double value = integral(filter);
    evidence.require(value > 0 && std::isfinite(value),
                     [&] { return fmt::format("it is {}", value); });
    return evidence;
}

Evidence rfilter_weights(const RFilter& filter) {
    Evidence evidence("weights of pixels are the filter");
    if (!(integral(filter) > 0)) return evidence;
    const ReconstructionFilter table(filter);
    float own = 0;  // the largest of all weights
    for (int i = 0; i < 256; ++i) {
        own = std::max(own, filter.evaluate(0.5f - (static_cast<float>(i) + 0.5f) / 256));
    }
    for (int i = 0; i < 256; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) / 256;
        const auto weights = table.weights(x);
        for (int k = -table.reach(); k <= table.reach(); ++k) {
            const float expected = filter.evaluate(static_cast<float>(k) + 0.5f - x) / own;
            const auto weight =
                static_cast<float>(weights[static_cast<std::size_t>(k + table.reach())]);
            evidence.require(std::abs(weight * 0x1p-14f - expected) <= 0x1p-14f, [&] {
                return fmt::format("{} at pixel {}, not {}", weight * 0x1p-14f, k, expected);
            });
        }
        const float beyond = static_cast<float>(table.reach() + 1) + 0.5f - x;
        evidence.require(filter.evaluate(beyond) == 0,
                         [&] { return fmt::format("pixels beyond {} are left out", beyond); });
    }
    evidence.require(table.negative_weight() >= 0 && table.negative_weight() < 2, [&] {
        return fmt::format("negative lobes are {} of the integral", table.negative_weight());
    });
    return evidence;
}

std::vector<Evidence> check(const RFilter& filter, const Effort&) {
    return {rfilter_shape(filter), rfilter_integral(filter), rfilter_weights(filter)};
}

}  // namespace lucerna::contracts
