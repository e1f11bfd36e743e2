// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a NanoVDB grid, all of whose voxels can be read, or end in an error
/// message.
#include "plugins/volumes/nanovdb_file.h"
#include "tests/fuzz/vdb_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return lucerna::fuzz_vdb(lucerna::read_nanovdb, {data, size});
}
