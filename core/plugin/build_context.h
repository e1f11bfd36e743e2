// SPDX-License-Identifier: Apache-2.0
/// What Params needs to know of the scene that is being built.
#pragma once

#include "core/description/description.h"
#include "core/math/transform.h"

#include <filesystem>
#include <memory>
#include <string_view>

namespace lucerna {

class Object;

class BuildContext {
public:
    virtual ~BuildContext() = default;

    /// The object that was made of a nested element.
    virtual const Object* object(const Child& child) = 0;
    /// A plugin with its default parameters.
    virtual const Object* default_object(std::string_view kind, std::string_view type) = 0;
    /// An existing file, or an Error that lists where it was looked for.
    virtual std::filesystem::path find_file(const std::string& name) = 0;
    /// From the space of the scene file to the world in which the element is placed.
    virtual Transform placement(const Element& element) = 0;
    virtual Diagnostics& diagnostics() = 0;
    /// Only the list of parameters is wanted: nothing is given, what is required is made up.
    virtual bool describing() const { return false; }
    /// The scene was written for another version: unknown parameters are warnings.
    virtual bool lenient() const { return false; }
};

/// The plugin that stands for a kind when one is required and none is given.
std::string_view default_plugin(std::string_view kind);

}  // namespace lucerna
