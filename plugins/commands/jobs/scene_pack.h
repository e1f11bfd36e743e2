// SPDX-License-Identifier: Apache-2.0
/// A scene with all that it reads, in one folder: the scene file, what it includes, meshes,
/// pictures, spectra, and plugins that are not Lucerna's own. The copies name each other by their
/// names in the folder, whatever paths, search paths and parameters the scene used.
#pragma once

#include "core/render/session.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lucerna {

struct PackedScene {
    std::string name;                    ///< of the scene file, in the folder "scene"
    std::vector<std::string> overrides;  ///< those of the settings, with the names of the copies
    bool has_plugins = false;            ///< in the folder "plugins"
    /// Settings whose values are files, with the names of the copies.
    std::map<std::string, std::string> renamed_settings{};

    /// A setting of the scene or of a variant as the packed scene needs it.
    std::string renamed(const std::string& setting) const;
};

/// Writes `folder`/scene and, if the scene needs any, `folder`/plugins. The definitions of the
/// settings become defaults of the scene. Throws FileError.
///
/// `variants` are the same scene with more overrides, whose files and plugins are packed, too. Each
/// is built, which may throw SceneError, and `built` is called with its index.
PackedScene pack_scene(
    const Session& session, const SessionSettings& settings, const std::filesystem::path& folder,
    const std::vector<SessionSettings>& variants = {},
    const std::function<void(std::size_t index, const Session& variant)>& built = {});

}  // namespace lucerna
