// SPDX-License-Identifier: Apache-2.0
/// How draws are shared by lights at infinity and others where nothing else is known.
#pragma once

#include <cstddef>

namespace lucerna {

/// The share of n emitters at infinity, after pbrt-v4: n / (n + 1); all others count as one.
/// `others`: there are some.
inline float infinite_share(std::size_t emitters, bool others) {
    const auto n = static_cast<float>(emitters);
    return n > 0 ? n / (n + (others ? 1.0f : 0.0f)) : 0.0f;
}

}  // namespace lucerna
