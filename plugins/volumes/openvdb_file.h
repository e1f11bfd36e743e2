// SPDX-License-Identifier: Apache-2.0
/// Reads OpenVDB files (`.vdb`, versions 222 to 224 of the format): grids of floats and of three
/// floats, also if they are stored as halves.
///
/// OpenVDB reads the trees. Before, what the file says about lengths and places is checked, since
/// the library believes it; while it reads, the end of the file ends it. Trees that are damaged in
/// other ways can crash the library: it reads in a process of its own, which sends the dense grid.
#pragma once

#include "plugins/volumes/machine_memory.h"
#include "plugins/volumes/vdb_grid.h"

#include <filesystem>
#include <span>

namespace lucerna {

/// The grid of this name; empty: the only one, or "density". Throws Error, which begins with the
/// file's name, for what is no such file, is truncated or damaged, for grids that are no volumes,
/// as level sets, and for those that take more memory than there is.
VdbGrid read_openvdb(const std::filesystem::path& path, const std::string& grid);

/// The same of bytes in memory; `name` begins its messages, `memory` is what there is [bytes].
VdbGrid read_openvdb(std::span<const std::uint8_t> bytes, const std::string& name,
                     const std::string& grid, std::uint64_t memory = memory_of_machine());

}  // namespace lucerna
