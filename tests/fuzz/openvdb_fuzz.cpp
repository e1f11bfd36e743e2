// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either an OpenVDB grid, all of whose voxels can be read, or end in an error
/// message. The library asks for as much memory as a file says before it reads on, and lives on if
/// it gets none: run with -malloc_limit_mb=0 and ASAN_OPTIONS=allocator_may_return_null=1.
#include "plugins/volumes/openvdb_file.h"
#include "tests/fuzz/vdb_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return lucerna::fuzz_vdb(lucerna::read_openvdb, {data, size});
}
