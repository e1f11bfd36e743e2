// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a volume, all of whose voxels can be read, or end in an error message.
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "plugins/volumes/block_maxima.h"
#include "plugins/volumes/vol_file.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lucerna;
    try {
        const VolFile file = read_vol({data, size}, "fuzz");
        const Vector3i n = file.grid.resolution();
        if (file.grid.bytes().size() > size) std::abort();
        const BlockMaxima maxima(file.grid, "fuzz");
        // In the arithmetic of threads that render, where denormal numbers are zero.
        Workers(1).run(1, [&](std::int64_t) {
            const float largest = maxima.largest(file.grid, {Vector3i(0), n - 1});
            if (largest != maxima.largest() || maxima.smallest() > largest) std::abort();
            if (file.grid.largest(n - 1) > largest) std::abort();
        });
    } catch (const Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}
