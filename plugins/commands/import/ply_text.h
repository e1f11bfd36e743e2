// SPDX-License-Identifier: Apache-2.0
/// A mesh of assimp as a binary PLY file.
#pragma once

#include <assimp/mesh.h>

#include <cstddef>
#include <string>

namespace lucerna {

std::size_t triangles_of(const aiMesh& mesh);

/// Little-endian, with normals, texture coordinates and linear colours if the mesh has them. v
/// counts downwards in PLY files, as in Mitsuba, and upwards in assimp.
std::string ply_of(const aiMesh& mesh);

}  // namespace lucerna
