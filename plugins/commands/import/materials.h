// SPDX-License-Identifier: Apache-2.0
/// Materials of a model as BSDFs.
///
/// Matte ones stay as they are. Those of glTF become `principled`, which has the same parameters:
/// roughness with α = roughness² (glTF 2.0, appendix B), metal, transmission, clear coat. Phong's
/// highlights become plastics of α² = 2 / (exponent + 2) (Walter et al. 2007, section 5); glass
/// of other formats a smooth dielectric, opacity a mask.
#pragma once

#include "plugins/commands/import/account.h"
#include "plugins/commands/import/scene_text.h"

#include <assimp/material.h>

#include <functional>
#include <optional>
#include <string>

namespace lucerna {

class Materials {
public:
    /// `find_picture` gives the file name for a texture's path, or tells the account why not.
    using FindPicture = std::function<std::optional<std::string>(const std::string& path)>;

    Materials(SceneText& text, Account& account, FindPicture find_picture);

    /// With `vertex_colors`, for meshes that have them: they are the colour of the surface.
    void write(const aiMaterial& material, const std::string& id, bool vertex_colors);

    /// The emitter inside a shape, if the material shines.
    void write_emission(const aiMaterial& material);

    static std::string name_of(const aiMaterial& material);

private:
    /// A file, and where texture coordinates (v downwards) lie in it.
    struct Picture {
        std::string file;
        bool placed = false;
        aiVector2D along_u{1, 0}, along_v{0, 1}, offset{0, 0};

        /// glTF scales, turns counter-clockwise around (0, 0) and moves (KHR_texture_transform).
        /// assimp turns around the middle instead, with v upwards, and moves so that both agree.
        void place(const aiUVTransform& t);
    };

    struct Look;

    void surface(const aiMaterial& material, const Look& look);

    /// Roughness is in the green channel of glTF's picture, metal in the blue one.
    void principled(const aiMaterial& material, const Look& look);

    /// A number, or the channel of a picture if its factor is 1.
    void number(const char* name, const aiMaterial& material, aiTextureType type,
                const char* channel, float factor);

    void open(const std::string& type);

    void remark(const std::string& what) { remark_ += (remark_.empty() ? "" : "; ") + what; }

    /// A colour, or the picture in its place.
    void color(const char* name, const aiMaterial& material, aiColor3D value);

    /// `raw`: numbers, not colours.
    void bitmap(const std::string& name, const Picture& picture, bool raw,
                const std::string& channel = "");

    std::optional<Picture> texture(const aiMaterial& material, aiTextureType type) const;

    void drop_textures(const aiMaterial& material) const;

    SceneText& text_;
    Account& account_;
    FindPicture find_picture_;
    std::string open_id_, remark_;
    bool vertex_colors_ = false;
};

}  // namespace lucerna
