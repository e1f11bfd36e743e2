// SPDX-License-Identifier: Apache-2.0
/// serialized: a mesh from a file in Mitsuba's own format, which may hold many.
///
///   filename      string             required
///   shape_index   integer    0       which mesh of the file, counted from 0
///   face_normals  boolean    false   ignores vertex normals, which gives a faceted look
///   to_world      transform
///   flip_normals  boolean    false
///
/// Without normals, smooth ones are computed.
#include "core/base/file_bytes.h"
#include "plugins/shapes/serialized_reader.h"

namespace lucerna {
namespace {

class SerializedShape final : public Mesh {
public:
    explicit SerializedShape(const Params& params) : Mesh(params) {
        const int index = params.int32("shape_index", 0, non_negative, "which mesh of the file");
        const std::filesystem::path path = params.file("filename", "the serialized file");
        if (path.empty()) return;
        MeshData data = read_serialized(read_file_bytes(path), path.filename().string(),
                                        static_cast<std::uint32_t>(index), world_from_object());
        data.flip_v();  // it counts downwards in these files
        assign(params, std::move(data));
    }
};

}  // namespace

const PluginInfo plugin = describe<SerializedShape>("a mesh from a serialized file of Mitsuba");

}  // namespace lucerna
