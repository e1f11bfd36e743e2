// SPDX-License-Identifier: Apache-2.0
/// Looking for the files that a scene names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// The first regular file of this name in the folders; an absolute name is taken as it is. Throws
/// Error that lists the places where it was looked for.
std::filesystem::path find_file(std::string_view name, const std::vector<std::string>& folders);

/// The same for a folder.
std::filesystem::path find_folder(std::string_view name, const std::vector<std::string>& folders);

}  // namespace lucerna
