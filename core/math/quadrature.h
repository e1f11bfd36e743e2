// SPDX-License-Identifier: Apache-2.0
/// Numerical integration.
#pragma once

#include "core/math/vector.h"

#include <vector>

namespace lucerna {

/// Gauss–Legendre rule with n nodes: exact for polynomials up to degree 2n − 1.
class GaussLegendre {
public:
    explicit GaussLegendre(int n) {
        for (int i = 0; i < n; ++i) {
            // Newton's method for the roots of the Legendre polynomial Pₙ, from a first guess
            // that is good to O(n⁻²) (Press et al. 2007, "Numerical Recipes", 4.6.1).
            double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
            double slope = 1;
            for (int step = 0; step < 8; ++step) {
                double p = 1, previous = 0;
                for (int k = 1; k <= n; ++k) {
                    const double next = ((2 * k - 1) * x * p - (k - 1) * previous) / k;
                    previous = p;
                    p = next;
                }
                slope = n * (x * p - previous) / (x * x - 1);
                x -= p / slope;
            }
            nodes_.push_back({x, 2 / ((1 - x * x) * slope * slope)});
        }
    }

    /// ∫ f(x) dx from a to b.
    template <typename F>
    double integrate(double a, double b, F f) const {
        double sum = 0;
        for (const Node& node : nodes_) {
            sum += node.weight * f(0.5 * (a + b) + 0.5 * (b - a) * node.x);
        }
        return 0.5 * (b - a) * sum;
    }

private:
    struct Node {
        double x, weight;
    };
    std::vector<Node> nodes_;
};

}  // namespace lucerna
