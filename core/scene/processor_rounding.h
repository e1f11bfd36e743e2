// SPDX-License-Identifier: Apache-2.0
/// How this processor rounds what libraries compute with the instructions that it has.
#pragma once

#include <cstdint>

namespace lucerna {

/// A hash of distances and barycentric coordinates by Embree, and of functions of the C library.
/// Where it is the same, renders have the same bits. It differs between processors for which these
/// libraries have other code (without AVX2, with AVX-512), or whose approximate reciprocals differ.
/// Throws Error if Embree cannot be started.
std::uint64_t processor_rounding();

}  // namespace lucerna
