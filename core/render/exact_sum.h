// SPDX-License-Identifier: Apache-2.0
/// Sums that do not depend on the order of their terms.
#pragma once

namespace lucerna {

/// A sum kept as an unevaluated pair high + low, |low| <= ulp(high) / 2, so about 106 bits
/// (Knuth's and Dekker's error-free additions; Shewchuk 1997, "Adaptive Precision
/// Floating-Point Arithmetic", 2.3).
///
/// Terms are floats times integer weights below 2²⁸. They are summed without any error while their
/// magnitudes span less than about 2³⁴ at a million terms. So adding the sums of two machines gives
/// the bits of one machine that did it all.
template <typename Number>
struct ExactSumOf {
    Number high{};
    Number low{};

    Number value() const { return high + low; }

    void add(const Number& x) {
        const Number sum = high + x;
        const Number part = sum - high;
        const Number error = (high - (sum - part)) + (x - part);
        const Number small = low + error;
        high = sum + small;
        low = small - (high - sum);
    }

    void add(const ExactSumOf& x) {
        add(x.high);
        add(x.low);
    }
};

using ExactSum = ExactSumOf<double>;

/// Four numbers that vector registers add together.
using FourDoubles = double __attribute__((vector_size(32)));
using FourExactSums = ExactSumOf<FourDoubles>;

}  // namespace lucerna
