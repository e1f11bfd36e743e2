// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a mesh or end in an error message.
#include "plugins/shapes/serialized_reader.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const auto index = static_cast<std::uint32_t>(size % 3);
        const lucerna::MeshData mesh = lucerna::read_serialized({data, size}, "fuzz", index);
        const std::size_t vertices = mesh.positions.size();
        if (mesh.indices.size() % 3 != 0) std::abort();
        if (!mesh.normals.empty() && mesh.normals.size() != vertices) std::abort();
        if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) std::abort();
    } catch (const lucerna::Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}
