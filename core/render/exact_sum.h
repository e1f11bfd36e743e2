// SPDX-License-Identifier: Apache-2.0
/// Sums that do not depend on the order of their terms.
#pragma once

namespace lucerna {

/// A sum kept as an unevaluated pair high + low, |low| <= ulp(high) / 2, so about 106 bits
/// (Knuth's and Dekker's error-free additions; Shewchuk 1997, "Adaptive Precision
/// Floating-Point Arithmetic", 2.3).
///
/// Terms that are floats are summed without any error while their magnitudes span less than about
/// 2⁶⁰ at a million terms. So adding the sums of two machines gives the bits of one machine that
/// did it all.
struct ExactSum {
    double high = 0;
    double low = 0;

    double value() const { return high + low; }

    void add(double x) {
        const double sum = high + x;
        const double part = sum - high;
        const double error = (high - (sum - part)) + (x - part);
        normalize(sum, low + error);
    }

    void add(const ExactSum& x) {
        add(x.high);
        add(x.low);
    }

private:
    void normalize(double large, double small) {
        high = large + small;
        low = small - (high - large);
    }
};

}  // namespace lucerna
