// SPDX-License-Identifier: Apache-2.0
/// What the fuzz targets of mesh files share: any bytes are either a mesh or end in an error.
#pragma once

#include "core/base/error.h"
#include "plugins/shapes/mesh.h"

#include <cstdlib>

namespace lucerna {

/// Aborts unless `read()` gives a mesh whose arrays fit together, or an Error with words.
template <typename Read>
int check_mesh_reader(Read read) {
    try {
        const MeshData mesh = read();
        const std::size_t vertices = mesh.positions.size();
        if (mesh.indices.size() % 3 != 0) std::abort();
        if (!mesh.normals.empty() && mesh.normals.size() != vertices) std::abort();
        if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) std::abort();
    } catch (const Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}

}  // namespace lucerna
