// SPDX-License-Identifier: Apache-2.0
/// From a description to a scene: constructs plugins, knows none of them.
#pragma once

#include "core/description/description.h"
#include "core/plugin/registry.h"
#include "core/scene/scene.h"

#include <memory>
#include <vector>

namespace lucerna {

struct BuildOptions {
    int threads = 0;  ///< that may build; 0: all
};

/// Builds all that the scene names and nothing else. Errors are collected in `diagnostics`; if
/// there are any, those of reading among them, all are thrown when all have been found
/// (Diagnostics::throw_if_errors). A scene that is far from the
/// origin for its size is moved to it, in double precision.
std::unique_ptr<Scene> build_scene(const Description& description, Registry& registry,
                                   Diagnostics& diagnostics, const BuildOptions& options = {});

/// The parameters that a plugin declares: constructs it with nothing.
std::vector<ParameterInfo> describe_parameters(Registry& registry, std::string_view kind,
                                               std::string_view name);

/// Constructs a plugin that stands alone, such as a command, with its default parameters.
std::unique_ptr<Object> make_object(Registry& registry, std::string_view kind,
                                    std::string_view name);

/// Constructs one plugin of a kind from a fragment of a scene, for tests and tools:
/// `<bsdf type="diffuse"/>`. The objects it is made of are appended to `objects`.
const Object* build_object(const Element& element, const Description& description,
                           Registry& registry, Diagnostics& diagnostics,
                           std::vector<std::unique_ptr<Object>>& objects);

}  // namespace lucerna
