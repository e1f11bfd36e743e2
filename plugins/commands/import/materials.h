// SPDX-License-Identifier: Apache-2.0
/// Materials of a model as BSDFs.
///
/// Exact are matte ones; others are approximated by what has the same parameters here: metals and
/// plastics with a width α = roughness² (glTF 2.0, appendix B) or α² = 2 / (exponent + 2) (Walter
/// et al. 2007, section 5), glass by a smooth dielectric, opacity by a mask.
#pragma once

#include "plugins/commands/import/account.h"
#include "plugins/commands/import/scene_text.h"

#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

namespace lucerna {

class Materials {
public:
    /// `find_picture` gives the file name for a texture's path, or tells the account why not.
    using FindPicture = std::function<std::optional<std::string>(const std::string& path)>;

    Materials(SceneText& text, Account& account, FindPicture find_picture)
        : text_(text), account_(account), find_picture_(std::move(find_picture)) {}

    void write(const aiMaterial& material, const std::string& id) {
        const Look look(material);
        open_id_ = " id=\"" + id + "\"";
        remark_.clear();
        const bool masked = look.opacity < 1;
        if (masked) {
            open("mask");
            text_.number("opacity", static_cast<double>(look.opacity));
            remark("opacity by a mask");
        }
        if (look.transmission > 0.5f) {
            open("dielectric");
            text_.number("int_ior", static_cast<double>(look.ior));
            remark("smooth glass");
        } else {
            if (look.two_sided) open("twosided");
            opaque(material, look);
            if (look.two_sided) text_.close("bsdf");
        }
        if (look.transmission > 0.5f) text_.close("bsdf");
        if (masked) text_.close("bsdf");
        drop_textures(material);
        account_.note(remark_.empty() ? Fate::converted : Fate::approximated, "material",
                      name_of(material), remark_);
    }

    /// The emitter inside a shape, if the material shines.
    void write_emission(const aiMaterial& material) {
        aiColor3D color(0, 0, 0);
        material.Get(AI_MATKEY_COLOR_EMISSIVE, color);
        float strength = 1;
        material.Get(AI_MATKEY_EMISSIVE_INTENSITY, strength);
        color = color * strength;
        if (color.IsBlack()) return;
        text_.open(R"(emitter type="area")");
        const std::optional<std::string> picture = texture(material, aiTextureType_EMISSIVE);
        if (picture && color == aiColor3D(1, 1, 1)) {
            bitmap("radiance", *picture);
        } else {
            text_.rgb("radiance", color);
            if (picture) remark_ = "texture of the emission left out, since it has a factor";
        }
        text_.close("emitter");
        account_.note(Fate::approximated, "emission", name_of(material),
                      "1 is taken as a radiance of 1 W/(m² sr)");
    }

    static std::string name_of(const aiMaterial& material) {
        aiString name;
        material.Get(AI_MATKEY_NAME, name);
        return name.length > 0 ? name.C_Str() : "(without a name)";
    }

private:
    /// What a material says about itself.
    struct Look {
        aiColor3D color{0.8f, 0.8f, 0.8f}, specular{0, 0, 0};
        float opacity = 1, transmission = 0, ior = 1.5f, exponent = 0;
        std::optional<float> metallic, roughness;
        bool two_sided = true;

        explicit Look(const aiMaterial& m) {
            m.Get(AI_MATKEY_COLOR_DIFFUSE, color);
            aiColor4D base;
            if (m.Get(AI_MATKEY_BASE_COLOR, base) == aiReturn_SUCCESS) {
                color = {base.r, base.g, base.b};
            }
            m.Get(AI_MATKEY_COLOR_SPECULAR, specular);
            m.Get(AI_MATKEY_OPACITY, opacity);
            m.Get(AI_MATKEY_TRANSMISSION_FACTOR, transmission);
            m.Get(AI_MATKEY_REFRACTI, ior);
            if (ior < 1.01f) ior = 1.5f;
            m.Get(AI_MATKEY_SHININESS, exponent);
            float value = 0;
            if (m.Get(AI_MATKEY_METALLIC_FACTOR, value) == aiReturn_SUCCESS) metallic = value;
            if (m.Get(AI_MATKEY_ROUGHNESS_FACTOR, value) == aiReturn_SUCCESS) roughness = value;
            int shading = aiShadingMode_Phong;
            m.Get(AI_MATKEY_SHADING_MODEL, shading);
            if (shading == aiShadingMode_Gouraud || shading == aiShadingMode_Flat) exponent = 0;
            // Only glTF speaks of sides and of how opacity is meant.
            aiString mode;
            if (m.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
                if (std::string(mode.C_Str()) == "OPAQUE") opacity = 1;
                int sides = 0;
                m.Get(AI_MATKEY_TWOSIDED, sides);
                two_sided = sides != 0;
            }
            opacity = std::clamp(opacity, 0.0f, 1.0f);
        }

        bool shiny() const { return metallic || (!specular.IsBlack() && exponent > 0); }
        /// Width of the distribution of slopes.
        float alpha() const {
            if (metallic) return std::max(1e-3f, roughness.value_or(1) * roughness.value_or(1));
            return std::sqrt(2 / (exponent + 2));
        }
    };

    void opaque(const aiMaterial& material, const Look& look) {
        if (look.metallic.value_or(0) > 0.5f) {
            open("roughconductor");
            text_.string("distribution", "ggx");
            text_.number("alpha", static_cast<double>(look.alpha()));
            color("specular_reflectance", material, look.color);
            remark(*look.metallic < 1 ? "metal, though partly metallic" : "metal");
        } else if (look.shiny()) {
            open("roughplastic");
            text_.string("distribution", "ggx");
            text_.number("alpha", static_cast<double>(look.alpha()));
            color("diffuse_reflectance", material, look.color);
            remark(look.metallic ? "plastic of the same roughness"
                                 : "plastic for Phong's highlight");
        } else {
            open("diffuse");
            color("reflectance", material, look.color);
        }
        text_.close("bsdf");
    }

    void open(const std::string& type) {
        text_.open("bsdf type=\"" + type + "\"" + open_id_);
        open_id_.clear();  // the outermost has the id
    }

    void remark(const std::string& what) { remark_ += (remark_.empty() ? "" : "; ") + what; }

    /// A colour, or the picture in its place.
    void color(const char* name, const aiMaterial& material, aiColor3D value) {
        std::optional<std::string> picture = texture(material, aiTextureType_BASE_COLOR);
        if (!picture) picture = texture(material, aiTextureType_DIFFUSE);
        if (picture) {
            bitmap(name, *picture);
            const bool white = value.r > 0.99f && value.g > 0.99f && value.b > 0.99f;
            if (!white) remark("the picture without its factor");
            return;
        }
        const aiColor3D kept(std::clamp(value.r, 0.0f, 1.0f), std::clamp(value.g, 0.0f, 1.0f),
                             std::clamp(value.b, 0.0f, 1.0f));
        if (!(kept == value)) remark("colours above 1 are cut");
        text_.rgb(name, kept);
    }

    void bitmap(const std::string& name, const std::string& picture) {
        text_.open(R"(texture type="bitmap" name=")" + name + "\"");
        text_.string("filename", picture);
        text_.close("texture");
    }

    std::optional<std::string> texture(const aiMaterial& material, aiTextureType type) const {
        aiString path;
        if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS) return {};
        return find_picture_(path.C_Str());
    }

    void drop_textures(const aiMaterial& material) const {
        const std::pair<aiTextureType, const char*> others[] = {
            {aiTextureType_SPECULAR, "of the highlight"},
            {aiTextureType_HEIGHT, "of heights"},
            {aiTextureType_NORMALS, "of normals"},
            {aiTextureType_SHININESS, "of the exponent"},
            {aiTextureType_OPACITY, "of the opacity"},
            {aiTextureType_METALNESS, "of metal"},
            {aiTextureType_DIFFUSE_ROUGHNESS, "of the roughness"}};
        for (const auto& [type, what] : others) {
            if (material.GetTextureCount(type) == 0) continue;
            account_.note(Fate::dropped, "texture", name_of(material), what);
        }
    }

    SceneText& text_;
    Account& account_;
    FindPicture find_picture_;
    std::string open_id_, remark_;
};

}  // namespace lucerna
