// SPDX-License-Identifier: Apache-2.0
/// Reads NanoVDB files (`.nvdb`, major version 32 of the format, all of its compressions): grids of
/// floats, of floats quantized to 4, 8, 16 or any number of bits, and of three floats.
///
/// Nodes are found by offsets that the file states; each is checked before it is followed.
#pragma once

#include "plugins/volumes/machine_memory.h"
#include "plugins/volumes/vdb_grid.h"

#include <filesystem>
#include <span>

namespace lucerna {

/// The grid of this name; empty: the only one, or "density". Throws Error, which begins with the
/// file's name, for what is no such file, is truncated or inconsistent, for grids that are no
/// volumes, as level sets, and for those that take more memory than there is.
VdbGrid read_nanovdb(const std::filesystem::path& path, const std::string& grid);

/// The same of bytes in memory; `name` begins its messages, `memory` is what there is [bytes].
VdbGrid read_nanovdb(std::span<const std::uint8_t> bytes, const std::string& name,
                     const std::string& grid, std::uint64_t memory = memory_of_machine());

}  // namespace lucerna
