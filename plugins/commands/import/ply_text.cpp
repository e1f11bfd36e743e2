// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/ply_text.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

namespace lucerna {

std::size_t triangles_of(const aiMesh& mesh) {
    std::size_t count = 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) count += mesh.mFaces[i].mNumIndices == 3 ? 1 : 0;
    return count;
}

std::string ply_of(const aiMesh& mesh) {
    const bool normals = mesh.HasNormals(), uvs = mesh.HasTextureCoords(0);
    const bool colors = mesh.HasVertexColors(0);
    std::string bytes = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n{}{}{}"
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.mNumVertices,
        normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
        uvs ? "property float u\nproperty float v\n" : "",
        colors ? "property float r\nproperty float g\nproperty float b\n" : "", triangles_of(mesh));
    const auto put = [&](std::uint32_t value) {
        for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
    };
    const auto put_float = [&](float value) { put(std::bit_cast<std::uint32_t>(value)); };
    const auto put_vector = [&](const aiVector3D& v) {
        for (unsigned i = 0; i < 3; ++i) put_float(v[i]);
    };
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
        put_vector(mesh.mVertices[i]);
        if (normals) put_vector(mesh.mNormals[i]);
        if (uvs) {
            put_float(mesh.mTextureCoords[0][i].x);
            put_float(1 - mesh.mTextureCoords[0][i].y);
        }
        for (unsigned k = 0; colors && k < 3; ++k) put_float(mesh.mColors[0][i][k]);
    }
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices != 3) continue;
        bytes += '\3';
        for (unsigned k = 0; k < 3; ++k) put(face.mIndices[k]);
    }
    return bytes;
}

}  // namespace lucerna
