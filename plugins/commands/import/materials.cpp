// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/materials.h"

#include <assimp/GltfMaterial.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lucerna {

/// What a material says about itself.
struct Materials::Look {
    aiColor3D color{0.8f, 0.8f, 0.8f}, specular{0, 0, 0};
    float opacity = 1, transmission = 0, ior = 1.5f, exponent = 0;
    std::optional<float> metallic;  ///< only if the material has the parameters of glTF
    float roughness = 1, clearcoat = 0, clearcoat_roughness = 0;
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
        m.Get(AI_MATKEY_ROUGHNESS_FACTOR, roughness);
        m.Get(AI_MATKEY_CLEARCOAT_FACTOR, clearcoat);
        m.Get(AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR, clearcoat_roughness);
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

    bool shiny() const { return !specular.IsBlack() && exponent > 0; }
    bool transmits() const { return transmission > (metallic ? 0.0f : 0.5f); }
};

void Materials::Picture::place(const aiUVTransform& t) {
    placed = true;
    const float c = std::cos(-t.mRotation), s = std::sin(-t.mRotation);
    along_u = {c * t.mScaling.x, -s * t.mScaling.x};
    along_v = {s * t.mScaling.y, c * t.mScaling.y};
    offset = {t.mTranslation.x - 0.5f * t.mScaling.x * (1 - c + s),
              0.5f * t.mScaling.y * (s + c - 1) + 1 - t.mScaling.y - t.mTranslation.y};
}

Materials::Materials(SceneText& text, Account& account, FindPicture find_picture)
    : text_(text), account_(account), find_picture_(std::move(find_picture)) {}

void Materials::write(const aiMaterial& material, const std::string& id, bool vertex_colors) {
    const Look look(material);
    vertex_colors_ = vertex_colors;
    open_id_ = " id=\"" + id + "\"";
    remark_.clear();
    const bool masked = look.opacity < 1;
    if (masked) {
        open("mask");
        text_.number("opacity", static_cast<double>(look.opacity));
        remark("opacity by a mask");
    }
    const std::optional<Picture> normals = texture(material, aiTextureType_NORMALS);
    const bool sided = look.two_sided && !look.transmits();
    if (sided) open("twosided");
    if (normals) {
        open("normalmap");
        bitmap("normalmap", *normals, true);
    }
    surface(material, look);
    if (normals) text_.close("bsdf");
    if (sided) text_.close("bsdf");
    if (masked) text_.close("bsdf");
    drop_textures(material);
    account_.note(remark_.empty() ? Fate::converted : Fate::approximated, "material",
                  name_of(material), remark_);
}

void Materials::write_emission(const aiMaterial& material) {
    aiColor3D color(0, 0, 0);
    material.Get(AI_MATKEY_COLOR_EMISSIVE, color);
    float strength = 1;
    material.Get(AI_MATKEY_EMISSIVE_INTENSITY, strength);
    color = color * strength;
    if (color.IsBlack()) return;
    text_.open(R"(emitter type="area")");
    const std::optional<Picture> picture = texture(material, aiTextureType_EMISSIVE);
    if (picture && color == aiColor3D(1, 1, 1)) {
        bitmap("radiance", *picture, false);
    } else {
        text_.rgb("radiance", color);
        if (picture) remark_ = "texture of the emission left out, since it has a factor";
    }
    text_.close("emitter");
    account_.note(Fate::approximated, "emission", name_of(material),
                  "1 is taken as a radiance of 1 W/(m² sr)");
}

std::string Materials::name_of(const aiMaterial& material) {
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    return name.length > 0 ? name.C_Str() : "(without a name)";
}

void Materials::surface(const aiMaterial& material, const Look& look) {
    if (look.metallic) {
        open("principled");
        principled(material, look);
    } else if (look.transmits()) {
        open("dielectric");
        text_.number("int_ior", static_cast<double>(look.ior));
        remark("smooth glass");
    } else if (look.shiny()) {
        open("roughplastic");
        text_.string("distribution", "ggx");
        text_.number("alpha", static_cast<double>(std::sqrt(2 / (look.exponent + 2))));
        color("diffuse_reflectance", material, look.color);
        remark("plastic for Phong's highlight");
    } else {
        open("diffuse");
        color("reflectance", material, look.color);
    }
    text_.close("bsdf");
}

void Materials::principled(const aiMaterial& material, const Look& look) {
    color("base_color", material, look.color);
    number("roughness", material, aiTextureType_DIFFUSE_ROUGHNESS, "g", look.roughness);
    number("metallic", material, aiTextureType_METALNESS, "b", *look.metallic);
    text_.number("eta", static_cast<double>(look.ior));
    if (look.transmits()) {
        text_.number("spec_trans", static_cast<double>(look.transmission));
    }
    if (look.clearcoat > 0) {
        // glTF's coat has a reflectance of 0.04, the one here a quarter of it.
        text_.number("clearcoat", static_cast<double>(look.clearcoat));
        const float alpha = look.clearcoat_roughness * look.clearcoat_roughness;
        text_.number("clearcoat_gloss",
                     static_cast<double>(std::clamp((0.1f - alpha) / 0.099f, 0.0f, 1.0f)));
        remark("the clear coat is a quarter as strong");
    }
}

void Materials::number(const char* name, const aiMaterial& material, aiTextureType type,
                       const char* channel, float factor) {
    const std::optional<Picture> picture = texture(material, type);
    if (!picture) return text_.number(name, static_cast<double>(factor));
    if (factor != 1) remark(std::string(name) + " by the picture without its factor");
    bitmap(name, *picture, true, channel);
}

void Materials::open(const std::string& type) {
    text_.open("bsdf type=\"" + type + "\"" + open_id_);
    open_id_.clear();  // the outermost has the id
}

void Materials::color(const char* name, const aiMaterial& material, aiColor3D value) {
    std::optional<Picture> picture = texture(material, aiTextureType_BASE_COLOR);
    if (!picture) picture = texture(material, aiTextureType_DIFFUSE);
    if (picture) {
        bitmap(name, *picture, false);
        if (vertex_colors_) remark("the picture without the colours of vertices");
        const bool white = value.r > 0.99f && value.g > 0.99f && value.b > 0.99f;
        if (!white) remark("the picture without its factor");
        return;
    }
    if (vertex_colors_) {
        text_.open(R"(texture type="mesh_attribute" name=")" + std::string(name) + "\"");
        text_.string("name", "vertex_color");
        if (value.r != 1) text_.number("scale", static_cast<double>(value.r));
        text_.close("texture");
        if (value.r != value.g || value.g != value.b) {
            remark("colours of vertices with only the red of their factor");
        }
        return;
    }
    const aiColor3D kept(std::clamp(value.r, 0.0f, 1.0f), std::clamp(value.g, 0.0f, 1.0f),
                         std::clamp(value.b, 0.0f, 1.0f));
    if (!(kept == value)) remark("colours above 1 are cut");
    text_.rgb(name, kept);
}

void Materials::bitmap(const std::string& name, const Picture& picture, bool raw,
                       const std::string& channel) {
    text_.open(R"(texture type="bitmap" name=")" + name + "\"");
    text_.string("filename", picture.file);
    if (picture.placed) text_.uv_matrix(picture.along_u, picture.along_v, picture.offset);
    if (raw) text_.empty(R"(boolean name="raw" value="true")");
    if (!channel.empty()) text_.string("channel", channel);
    text_.close("texture");
}

std::optional<Materials::Picture> Materials::texture(const aiMaterial& material,
                                                     aiTextureType type) const {
    aiString path;
    if (material.GetTexture(type, 0, &path) != aiReturn_SUCCESS) return {};
    const std::optional<std::string> file = find_picture_(path.C_Str());
    if (!file) return {};
    Picture picture{.file = *file};
    aiUVTransform placed;
    if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), placed) == aiReturn_SUCCESS) {
        picture.place(placed);
    }
    return picture;
}

void Materials::drop_textures(const aiMaterial& material) const {
    const std::pair<aiTextureType, const char*> others[] = {
        {aiTextureType_SPECULAR, "of the highlight"},
        {aiTextureType_HEIGHT, "of heights"},
        {aiTextureType_CLEARCOAT, "of the clear coat"},
        {aiTextureType_TRANSMISSION, "of the transmission"},
        {aiTextureType_SHEEN, "of the sheen"},
        {aiTextureType_SHININESS, "of the exponent"},
        {aiTextureType_OPACITY, "of the opacity"}};
    for (const auto& [type, what] : others) {
        if (material.GetTextureCount(type) == 0) continue;
        account_.note(Fate::dropped, "texture", name_of(material), what);
    }
}

}  // namespace lucerna
