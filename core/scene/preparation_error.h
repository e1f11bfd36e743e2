// SPDX-License-Identifier: Apache-2.0
/// From Scene, which prepares objects, to the builder, which knows where they stand in the file.
#pragma once

#include "core/base/error.h"

#include <cstddef>

namespace lucerna {

/// What Object::prepare threw.
class PreparationError : public Error {
public:
    PreparationError(std::size_t object, const Error& reason)
        : Error(reason.what()), object_(object) {}

    /// Index in SceneParts::objects.
    std::size_t object() const { return object_; }

private:
    std::size_t object_;
};

}  // namespace lucerna
