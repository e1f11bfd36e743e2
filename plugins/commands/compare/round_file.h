// SPDX-License-Identifier: Apache-2.0
/// A round as a file: an OpenEXR picture with a layer for each snapshot of each variant
/// ("variant1.picture3"), and all figures that a report needs as attributes.
#pragma once

#include "plugins/commands/compare/round.h"

#include <filesystem>
#include <string>

namespace lucerna {

/// `comparison` says what the round is a round of. Throws FileError.
void write_round(const std::filesystem::path& path, const Round& round,
                 const std::string& comparison);

/// Throws FileError for files that are no rounds or damaged, Error for those of another comparison.
Round read_round(const std::filesystem::path& path, const std::string& comparison);

}  // namespace lucerna
