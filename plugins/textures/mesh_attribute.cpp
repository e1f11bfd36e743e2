// SPDX-License-Identifier: Apache-2.0
/// mesh_attribute: numbers that the file of a mesh gives to its vertices or faces, as colours.
///
/// Between vertices they are interpolated linearly. What there is depends on the mesh: see `ply`
/// and `serialized`. Whether a shape has the attribute is checked when the scene is built.
#include "core/interfaces/shape.h"
#include "core/interfaces/texture.h"

namespace lucerna {
namespace {

class MeshAttributeTexture final : public Texture {
public:
    explicit MeshAttributeTexture(const Params& params)
        : name_(params.string("name", "", "as vertex_color, or face_ and a name; required")),
          scale_(params.real("scale", 1, any_value, "factor of all values")) {
        if (!name_.starts_with("vertex_") && !name_.starts_with("face_")) {
            params.error("name",
                         "\"name\" must begin with \"vertex_\" or \"face_\", as \"vertex_color\"");
        }
    }

    std::string_view attribute() const override { return name_; }
    Color color_at(const Interaction& at) const override {
        return scale_ * at.shape->attribute(name_, at);
    }
    float real_at(const Interaction& at) const override { return luminance(color_at(at)); }

    // Without a surface, nothing is known but the factor.
    Color color(Vector2) const override { return Color(0.5f * scale_); }
    float real(Vector2) const override { return 0.5f * scale_; }
    Vector2 gradient(Vector2) const override { return Vector2(0); }
    Color mean() const override { return Color(0.5f * std::abs(scale_)); }
    float max() const override { return std::abs(scale_); }

private:
    std::string name_;
    float scale_;
};

}  // namespace

const PluginInfo plugin = describe<MeshAttributeTexture>("numbers of vertices or faces of a mesh");

}  // namespace lucerna
