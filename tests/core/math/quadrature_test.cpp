// SPDX-License-Identifier: Apache-2.0
#include "core/math/quadrature.h"

#include <gtest/gtest.h>

namespace lucerna {

TEST(Quadrature, exact_for_polynomials) {
    for (const int n : {1, 2, 5, 16, 64}) {
        const GaussLegendre rule(n);
        for (int degree = 0; degree <= std::min(2 * n - 1, 40); ++degree) {
            const double integral =
                rule.integrate(0, 2, [degree](double x) { return std::pow(x / 2, degree); });
            EXPECT_NEAR(integral, 2.0 / (degree + 1), 1e-13) << n << " nodes, degree " << degree;
        }
    }
}

}  // namespace lucerna
