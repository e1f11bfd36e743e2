// SPDX-License-Identifier: Apache-2.0
/// Finds plugins: (kind, name) → library → PluginInfo. Opens libraries by dlopen.
///
/// A library is opened when it is first named, with RTLD_NOW | RTLD_LOCAL, and never closed.
#pragma once

#include "core/plugin/plugin.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna {

/// Version of the core library: "0.1.0".
const char* core_version();

/// Libraries and compiler that it was built with: "Embree 3.13.5, OpenEXR 3.1.5, …".
const char* core_built_with();

/// "bsdf" → "bsdfs": the folder of a kind of plugin.
std::string plugin_folder(std::string_view kind);

/// All kinds, in the order in which they are listed.
const std::vector<std::string>& plugin_kinds();

/// The name under which a plugin of other renderers is known here ("ldrfilm" → "hdrfilm"), or the
/// name itself.
std::string_view plugin_alias(std::string_view kind, std::string_view name);

class Registry {
public:
    /// Looks in `folders` first, then in $LUCERNA_PLUGINS (separated by colons), then in
    /// lucerna/plugins beside the core library.
    explicit Registry(std::vector<std::filesystem::path> folders = {});

    /// Opens the plugin if need be. Throws PluginError for a library that cannot be used, Error if
    /// there is none; the message lists what there is.
    const PluginInfo& find(std::string_view kind, std::string_view name);

    /// Makes a plugin known that is part of the program instead of a library.
    void add(std::string_view name, const PluginInfo& info);

    /// Names of all plugins of a kind that could be opened, sorted; without opening them.
    std::vector<std::string> names(std::string_view kind) const;
    /// The library of a plugin, or empty.
    std::filesystem::path path(std::string_view kind, std::string_view name) const;
    /// What has been opened, as "bsdfs/diffuse", sorted.
    std::vector<std::string> opened() const;
    const std::vector<std::filesystem::path>& folders() const { return folders_; }

private:
    std::vector<std::filesystem::path> folders_;
    std::map<std::pair<std::string, std::string>, const PluginInfo*> opened_;
};

}  // namespace lucerna
