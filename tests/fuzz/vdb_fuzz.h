// SPDX-License-Identifier: Apache-2.0
/// What the fuzz targets of files of sparse grids try.
#pragma once

#include "core/base/error.h"
#include "plugins/volumes/vdb_grid.h"

#include <cstdlib>
#include <span>

namespace lucerna {

using ReadVdb = VdbGrid (*)(std::span<const std::uint8_t>, const std::string&, const std::string&,
                            std::uint64_t);

inline int fuzz_vdb(ReadVdb read, std::span<const std::uint8_t> bytes) {
    constexpr std::uint64_t memory = std::uint64_t{64} << 20;
    try {
        const VdbGrid grid = read(bytes, "fuzz", "", memory);
        if (grid.voxels.bytes().size() > memory) std::abort();
        const BlockMaxima maxima(grid.voxels, "fuzz", grid.first);
        if (maxima.smallest() > maxima.largest()) std::abort();
    } catch (const Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}

}  // namespace lucerna
