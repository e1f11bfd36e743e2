// SPDX-License-Identifier: Apache-2.0
/// Changes of a scene from the command line: `--set integrator.max_depth=8`.
///
/// A path leads from the scene to an object and ends with what is set there. Each step names a
/// nested object by its name, its id or its kind; the first may also be any id of the scene, even
/// one with points. The last step is a parameter, or a kind or "type", which replaces the type of
/// an object:
///
///   integrator.max_depth=8          a parameter
///   integrator.light_sampler=power  the type of a nested object, which is made if there is none
///   white.reflectance=0.5           a parameter of the element with id "white"
///   sensor.film.width=320           also where sensor or film are not in the scene
#pragma once

#include "core/description/description.h"

#include <string>
#include <vector>

namespace lucerna {

/// Applies them in order; what cannot be applied is reported.
void apply_overrides(const std::vector<std::string>& overrides, Description& description,
                     Diagnostics& diagnostics);

/// Applies `max_depth=8` and the like to one element: the same, with paths that start there.
/// Messages call them `name`.
void apply_settings(const std::vector<std::string>& settings, const std::string& name,
                    Element& element, Description& description, Diagnostics& diagnostics);

}  // namespace lucerna
