// SPDX-License-Identifier: Apache-2.0
/// Reads Mitsuba's volume files (`.vol`, version 3): a header of 48 bytes and dense numbers, all
/// little-endian (documentation of Mitsuba 3 and of Mitsuba 0.6, "gridvolume").
///
/// Of the encodings, float32 (1), float16 (2) and uint8 (3) are read; 4 holds quantized directions.
/// Volumes have one channel, three, or the six of symmetric matrices.
#pragma once

#include "core/math/bounds.h"
#include "plugins/volumes/voxel_grid.h"

#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace lucerna {

struct VolFile {
    VoxelGrid grid;
    /// As the file states it. Nothing is promised: it may be empty or hold no numbers.
    Bounds3 bounds;
    std::vector<std::string> warnings;
};

/// Throws Error, which begins with the file's name, for what is no such file, is truncated, holds
/// more numbers than bytes, or does not fit into the memory of this machine. The numbers
/// themselves may be anything. Memory beyond the file's own size is never asked for.
VolFile read_vol(const std::filesystem::path& path);

/// The same of bytes in memory; `name` begins its messages.
VolFile read_vol(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace lucerna
