// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a NanoVDB grid, all of whose voxels can be read, or end in an error
/// message.
#include "core/base/error.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/nanovdb_file.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::uint64_t memory = std::uint64_t{64} << 20;
    try {
        const lucerna::VdbGrid grid = lucerna::read_nanovdb({data, size}, "fuzz", "", memory);
        if (grid.voxels.bytes().size() > memory) std::abort();
        const lucerna::BlockMaxima maxima(grid.voxels, "fuzz", grid.first);
        if (maxima.smallest() > maxima.largest()) std::abort();
    } catch (const lucerna::Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}
