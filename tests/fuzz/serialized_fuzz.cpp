// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a mesh or end in an error message.
#include "plugins/shapes/serialized_reader.h"
#include "tests/fuzz/mesh_fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto index = static_cast<std::uint32_t>(size % 3);
    return lucerna::check_mesh_reader([&] {
        return lucerna::read_serialized({data, size}, "fuzz", index);
    });
}
