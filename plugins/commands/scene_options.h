// SPDX-License-Identifier: Apache-2.0
/// The arguments with which commands choose a scene and change it.
#pragma once

#include "core/command_line/arguments.h"
#include "core/render/session.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct SceneOptions {
    std::string scene;
    std::vector<int> resolution;  ///< width and height, or empty [pixels]
    std::vector<std::pair<std::string, std::string>> defines;
    std::vector<std::string> overrides, plugin_folders;
    int threads = 0;  ///< 0: one for each processor
};

/// All of them but the scene and the threads.
inline void declare_scene_options(Arguments& arguments, SceneOptions& options) {
    arguments.option("--resolution", "WxH", options.resolution, 'x', 2, {.min = 1, .max = 65536},
                     "size of the whole image [pixels]");
    arguments.option("-D,--define", "NAME=VALUE", options.defines,
                     "value of $NAME in the scene; may be repeated");
    arguments.option("--set", "PATH=VALUE", options.overrides,
                     "changes the scene, for example integrator.max_depth=8 or "
                     "integrator.light_sampler=power; may be repeated");
    arguments.option("--plugins", "DIR", options.plugin_folders,
                     "looks for plugins in DIR first; may be repeated");
}

inline void declare_threads(Arguments& arguments, SceneOptions& options) {
    arguments.option("--threads", "N", options.threads, {.min = 0, .max = 4096},
                     "0, the default: one for each processor");
}

inline SessionSettings session_settings(const SceneOptions& options) {
    SessionSettings settings;
    settings.scene = options.scene;
    settings.threads = options.threads;
    settings.defines = options.defines;
    settings.overrides = options.overrides;
    settings.plugin_folders.assign(options.plugin_folders.begin(), options.plugin_folders.end());
    const char* names[] = {"width", "height"};
    for (std::size_t i = 0; i < options.resolution.size(); ++i) {
        settings.overrides.push_back(
            fmt::format("sensor.film.{}={}", names[i], options.resolution[i]));
    }
    return settings;
}

}  // namespace lucerna
