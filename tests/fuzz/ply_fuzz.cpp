// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a mesh or end in an error message.
#include "plugins/shapes/ply_reader.h"
#include "tests/fuzz/mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return lucerna::check_mesh_reader([&] { return lucerna::read_ply({data, size}, "fuzz"); });
}
