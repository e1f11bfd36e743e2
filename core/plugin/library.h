// SPDX-License-Identifier: Apache-2.0
/// Opens one plugin library, after checking that it can be trusted to load.
#pragma once

#include "core/plugin/plugin.h"

#include <filesystem>
#include <string_view>

namespace lucerna {

/// The folder of the core library itself, wherever it was installed.
std::filesystem::path core_library_folder();

/// Opens a library and returns what it exports. Throws PluginError, with the remedy, if the file
/// is damaged, was built for another core, implements another kind, or changes how the processor
/// rounds.
const PluginInfo& open_plugin(const std::filesystem::path& library, std::string_view kind);

}  // namespace lucerna
