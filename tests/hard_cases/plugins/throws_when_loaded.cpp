// SPDX-License-Identifier: Apache-2.0
/// A global whose constructor throws: it runs inside dlopen, where nothing can catch it.
#include <stdexcept>

namespace {
struct Thrower {
    Thrower() { throw std::runtime_error("thrown by a global"); }
} thrower;
}  // namespace
