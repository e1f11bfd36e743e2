// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/model.h"

#include "plugins/commands/import/field_of_view.h"
#include "plugins/commands/import/materials.h"
#include "plugins/commands/import/ply_text.h"
#include "plugins/commands/import/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace lucerna {

namespace {

class Model {
public:
    Model(const aiScene& scene, const ImportSettings& settings)
        : scene_(scene), settings_(settings) {}

    ImportedModel convert() {
        body_.open(R"(scene version="3.0.0")");
        std::string quoted = settings_.source;  // a comment must not hold two hyphens
        std::replace(quoted.begin(), quoted.end(), '-', '_');
        body_.comment("Imported from " + quoted);
        body_.empty(R"(integrator type="path")");
        collect(*scene_.mRootNode, aiMatrix4x4());
        sensor();
        write_materials();
        for (const Placed& placed : meshes_) shape(placed);
        lights();
        drop_the_rest();
        body_.close("scene");
        return {body_.str(), std::move(files_), std::move(account_)};
    }

private:
    struct Placed {
        unsigned mesh;
        aiMatrix4x4 to_world;
    };

    void collect(const aiNode& node, const aiMatrix4x4& parent) {
        const aiMatrix4x4 to_world = parent * node.mTransformation;
        nodes_[node.mName.C_Str()] = to_world;
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            meshes_.push_back({node.mMeshes[i], to_world});
            ++uses_[node.mMeshes[i]];
            const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
            for (unsigned k = 0; k < mesh.mNumVertices; ++k) include(to_world * mesh.mVertices[k]);
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) collect(*node.mChildren[i], to_world);
    }

    void include(const aiVector3D& p) {
        for (unsigned i = 0; i < 3; ++i) {
            low_[i] = std::min(low_[i], p[i]);
            high_[i] = std::max(high_[i], p[i]);
        }
    }

    aiMatrix4x4 matrix_of(const aiString& node) const {
        const auto found = nodes_.find(node.C_Str());
        return found == nodes_.end() ? aiMatrix4x4() : found->second;
    }

    static aiVector3D turned(const aiMatrix4x4& m, const aiVector3D& v) {
        aiVector3D result = aiMatrix3x3(m) * v;
        return result.Normalize();
    }

    void sensor() {
        aiVector3D origin, target, up(0, 1, 0);
        double fov = 40, aspect = 16.0 / 9;
        if (scene_.mNumCameras > 0) {
            const aiCamera& camera = *scene_.mCameras[0];
            const aiMatrix4x4 m = matrix_of(camera.mName);
            // A camera is where its node is; assimp 5.2 repeats that in mPosition for glTF.
            origin = m * aiVector3D();
            target = origin + turned(m, camera.mLookAt);
            up = turned(m, camera.mUp);
            if (camera.mAspect > 0) aspect = static_cast<double>(camera.mAspect);
            fov = horizontal_fov(camera, aspect, settings_.gltf) * 180 / std::numbers::pi;
            account_.note(Fate::converted, "camera", camera.mName.C_Str());
            for (unsigned i = 1; i < scene_.mNumCameras; ++i) {
                account_.note(Fate::dropped, "camera", scene_.mCameras[i]->mName.C_Str(),
                              "a scene has one: the first");
            }
        } else {
            target = meshes_.empty() ? aiVector3D() : (low_ + high_) * 0.5f;
            const float size = meshes_.empty() ? 1.0f : (high_ - low_).Length();
            origin = target + aiVector3D(0.6f, 0.45f, 1) * size;
            account_.note(Fate::added, "camera", "", "the model has none; this one sees all of it");
        }
        body_.open(R"(sensor type="perspective")");
        body_.number("fov", std::clamp(fov, 0.1, 179.0));
        body_.lookat(origin, target, up);
        body_.open(R"(film type="hdrfilm")");
        body_.whole("width", 1280);
        body_.whole("height", std::max(1, static_cast<int>(1280 / aspect + 0.5)));
        body_.close("film");
        body_.open(R"(sampler type="sobol")");
        body_.whole("sample_count", 64);
        body_.close("sampler");
        body_.close("sensor");
    }

    void write_materials() {
        Materials materials(body_, account_,
                            [this](const std::string& path) { return picture(path); });
        for (const Placed& placed : meshes_) {
            const aiMesh& mesh = *scene_.mMeshes[placed.mesh];
            std::string& id = ids_[surface_of(mesh)];
            if (!id.empty()) continue;
            const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
            id = names_.unique(Materials::name_of(material), "material");
            materials.write(material, id, mesh.HasVertexColors(0));
        }
    }

    /// A material, and whether it takes its colour from vertices.
    using Surface = std::pair<unsigned, bool>;
    static Surface surface_of(const aiMesh& mesh) {
        return {mesh.mMaterialIndex, mesh.HasVertexColors(0)};
    }

    void shape(const Placed& placed) {
        const aiMesh& mesh = *scene_.mMeshes[placed.mesh];
        const std::string name = mesh.mName.length > 0 ? mesh.mName.C_Str() : "(without a name)";
        if (triangles_of(mesh) == 0) {
            account_.note(Fate::dropped, "mesh", name, "points or lines only");
            return;
        }
        if (!repeated(placed.mesh)) {
            surface(placed.mesh, name, placed.to_world);
            return;
        }
        std::string& group = groups_[placed.mesh];
        if (group.empty()) {
            group = names_.unique(name + "_group", "group");
            body_.open("shape type=\"shapegroup\" id=\"" + group + "\"");
            surface(placed.mesh, name, aiMatrix4x4());
            body_.close("shape");
        }
        body_.open(R"(shape type="instance")");
        body_.empty("ref id=\"" + group + "\"");
        body_.matrix(placed.to_world);
        body_.close("shape");
    }

    /// Placed more than once, and no light: kept once in memory.
    bool repeated(unsigned index) const {
        aiColor3D emission(0, 0, 0);
        const aiMesh& mesh = *scene_.mMeshes[index];
        scene_.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_EMISSIVE, emission);
        return emission.IsBlack() && uses_.at(index) > 1;
    }

    void surface(unsigned index, const std::string& name, const aiMatrix4x4& to_world) {
        const aiMesh& mesh = *scene_.mMeshes[index];
        body_.open(R"(shape type="ply")");
        body_.string("filename", mesh_file(index, name));
        body_.matrix(to_world);
        body_.empty("ref id=\"" + ids_[surface_of(mesh)] + "\"");
        Materials(body_, account_, [this](const std::string& path) {
            return picture(path);
        }).write_emission(*scene_.mMaterials[mesh.mMaterialIndex]);
        body_.close("shape");
    }

    /// The file of a mesh, made when it is first used.
    std::string mesh_file(unsigned index, const std::string& name) {
        std::string& file = mesh_files_[index];
        if (!file.empty()) return file;
        const aiMesh& mesh = *scene_.mMeshes[index];
        file = settings_.folder + "/" + names_.unique(name, "mesh") + ".ply";
        files_.push_back({file, ply_of(mesh)});
        const bool partly = triangles_of(mesh) < mesh.mNumFaces;
        account_.note(partly ? Fate::approximated : Fate::converted, "mesh", name,
                      fmt::format("{} triangles{}", triangles_of(mesh),
                                  partly ? ", without points and lines" : ""));
        if (mesh.HasBones()) account_.note(Fate::dropped, "bones", name, "the mesh as it is bound");
        if (mesh.mNumAnimMeshes > 0) account_.note(Fate::dropped, "morph targets", name);
        if (mesh.HasVertexColors(0)) {
            account_.note(Fate::converted, "vertex colours", name, "as linear ones");
        }
        return file;
    }

    std::optional<std::string> picture(const std::string& path) {
        if (const aiTexture* embedded = scene_.GetEmbeddedTexture(path.c_str())) {
            return embedded_picture(*embedded, path);
        }
        namespace fs = std::filesystem;
        std::string clean = path;
        std::replace(clean.begin(), clean.end(), '\\', '/');
        for (std::size_t i; (i = clean.find("%20")) != std::string::npos;) clean.replace(i, 3, " ");
        if (clean.starts_with("file://")) clean = clean.substr(7);
        const fs::path file = settings_.model_folder / clean;
        std::error_code problem;
        if (!fs::is_regular_file(file, problem)) {
            account_.note(Fate::dropped, "picture", path, "there is no such file");
            return {};
        }
        if (!known_format(file.extension().string())) {
            account_.note(Fate::dropped, "picture", path, "not PNG, JPEG, Radiance or OpenEXR");
            return {};
        }
        account_.note(Fate::converted, "picture", path, "used where it is");
        const fs::path relative = fs::proximate(file, settings_.scene_folder, problem);
        return (problem ? fs::absolute(file) : relative).generic_string();
    }

    std::optional<std::string> embedded_picture(const aiTexture& texture, const std::string& path) {
        std::string& file = pictures_[&texture];
        if (!file.empty()) return file;
        const std::string format = texture.achFormatHint;
        if (texture.mHeight != 0 || !known_format("." + format)) {
            account_.note(Fate::dropped, "picture", path, "embedded, and not PNG or JPEG");
            return {};
        }
        file = settings_.folder + "/" + names_.unique("picture", "picture") + "." + format;
        files_.push_back(
            {file, std::string(reinterpret_cast<const char*>(texture.pcData), texture.mWidth)});
        account_.note(Fate::converted, "picture", path, "embedded; now " + file);
        return file;
    }

    static bool known_format(std::string extension) {
        for (char& c : extension)
            c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        for (const char* known : {".png", ".jpg", ".jpeg", ".hdr", ".exr"}) {
            if (extension == known) return true;
        }
        return false;
    }

    void lights() {
        bool any = false;
        for (const Placed& placed : meshes_) {
            aiColor3D emission(0, 0, 0);
            const aiMesh& mesh = *scene_.mMeshes[placed.mesh];
            scene_.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_COLOR_EMISSIVE, emission);
            any = any || !emission.IsBlack();
        }
        for (unsigned i = 0; i < scene_.mNumLights; ++i) any = light(*scene_.mLights[i]) || any;
        if (any) return;
        body_.open(R"(emitter type="constant")");
        body_.rgb("radiance", {1, 1, 1});
        body_.close("emitter");
        account_.note(Fate::added, "light", "", "the model has none; light from all sides");
    }

    /// False if it had to be dropped.
    bool light(const aiLight& light) {
        const std::string name = light.mName.C_Str();
        const aiMatrix4x4 m = matrix_of(light.mName);
        const aiVector3D position = m * light.mPosition, direction = turned(m, light.mDirection);
        std::string remark;
        const bool falls_off = light.mAttenuationQuadratic > 0 ||
                               (light.mAttenuationConstant == 0 && light.mAttenuationLinear == 0);
        switch (light.mType) {
            case aiLightSource_POINT:
                body_.open(R"(emitter type="point")");
                body_.point("position", position);
                body_.rgb("intensity", light.mColorDiffuse);
                if (!falls_off) remark = "falls off with the square of the distance here";
                break;
            case aiLightSource_DIRECTIONAL:
                body_.open(R"(emitter type="directional")");
                body_.vector("direction", direction);
                body_.rgb("irradiance", light.mColorDiffuse);
                break;
            case aiLightSource_SPOT: {
                constexpr float degrees = 180 / std::numbers::pi_v<float>;
                body_.open(R"(emitter type="spot")");
                const float outer = std::clamp(light.mAngleOuterCone * degrees, 0.1f, 90.0f);
                const float inner = std::clamp(light.mAngleInnerCone * degrees, 0.0f, outer);
                body_.number("cutoff_angle", static_cast<double>(outer));
                body_.number("beam_width", static_cast<double>(inner));
                body_.rgb("intensity", light.mColorDiffuse);
                body_.lookat(position, position + direction, any_up(direction));
                remark = "its edge falls linearly in the angle";
                break;
            }
            case aiLightSource_AMBIENT:
                body_.open(R"(emitter type="constant")");
                body_.rgb("radiance", light.mColorAmbient);
                remark = "light from all sides";
                break;
            default:
                account_.note(Fate::dropped, "light", name, "of a kind that is not known here");
                return false;
        }
        body_.close("emitter");
        account_.note(remark.empty() ? Fate::converted : Fate::approximated, "light", name, remark);
        return true;
    }

    static aiVector3D any_up(const aiVector3D& direction) {
        return std::abs(direction.y) < 0.9f ? aiVector3D(0, 1, 0) : aiVector3D(1, 0, 0);
    }

    void drop_the_rest() {
        for (unsigned i = 0; i < scene_.mNumAnimations; ++i) {
            account_.note(Fate::dropped, "animation", scene_.mAnimations[i]->mName.C_Str(),
                          "the model as it stands in the file");
        }
    }

    const aiScene& scene_;
    const ImportSettings& settings_;
    SceneText body_;
    Account account_;
    Names names_;
    std::vector<SideFile> files_;
    std::map<std::string, aiMatrix4x4> nodes_;
    std::vector<Placed> meshes_;
    std::map<unsigned, unsigned> uses_;  ///< how often each mesh is placed
    std::map<Surface, std::string> ids_;
    std::map<unsigned, std::string> mesh_files_, groups_;
    std::map<const aiTexture*, std::string> pictures_;
    aiVector3D low_{1e30f, 1e30f, 1e30f}, high_{-1e30f, -1e30f, -1e30f};
};

}  // namespace

ImportedModel import_model(const aiScene& scene, const ImportSettings& settings) {
    return Model(scene, settings).convert();
}

}  // namespace lucerna
