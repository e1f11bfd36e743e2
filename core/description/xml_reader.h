// SPDX-License-Identifier: Apache-2.0
/// Reads scenes in the XML format of Mitsuba. Knows the format, and no plugin.
///
///   objects      integrator light_sampler shape bsdf emitter texture sensor film sampler rfilter
///   properties   boolean integer float string point vector rgb srgb spectrum blackbody transform
///   steps        translate rotate scale lookat matrix, in a transform, in order
///   structure    ref alias default include path
///
/// Scenes of version < 2 are upgraded while they are read (legacy.h).
#pragma once

#include "core/description/description.h"
#include "core/description/xml_document.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct ReadOptions {
    std::vector<std::pair<std::string, std::string>> defines = {};  ///< `-D name=value`
    std::vector<std::string> overrides = {};                        ///< `--set path=value`
    ReadLimits limits = {};
};

/// Reads a scene with all that it includes. Everything that is wrong is collected in `diagnostics`;
/// after errors the description is incomplete and its hash 0.
Description read_scene(const std::filesystem::path& file, const ReadOptions& options,
                       Diagnostics& diagnostics);

/// The same for a scene in memory. Messages call it `name`, and files are looked for beside it.
Description read_scene_text(std::string text, std::string name, const ReadOptions& options,
                            Diagnostics& diagnostics);

}  // namespace lucerna
