// SPDX-License-Identifier: Apache-2.0
/// A model that assimp has read, as a scene: meshes, materials, lights, a camera.
///
/// What a model lacks, and a picture needs, is added and told: a camera that sees all of it, and
/// light from all sides. Photometric units of lights are taken as radiometric ones.
#pragma once

#include "plugins/commands/import/account.h"

#include <assimp/scene.h>

#include <filesystem>
#include <string>
#include <vector>

namespace lucerna {

/// A file beside the scene.
struct SideFile {
    std::string name;  ///< relative to the scene, with "/"
    std::string bytes;
};

struct ImportedModel {
    std::string text;             ///< of the scene, without the line of XML's version
    std::vector<SideFile> files;  ///< that the scene names
    Account account;
};

/// What to make of a model.
struct ImportSettings {
    std::string source;                  ///< what a comment in the scene calls the model
    std::string folder;                  ///< beside the scene, for meshes and embedded pictures
    std::filesystem::path model_folder;  ///< where the model's pictures are looked for
    std::filesystem::path scene_folder;
    bool gltf = false;  ///< the model is one
};

ImportedModel import_model(const aiScene& scene, const ImportSettings& settings);

}  // namespace lucerna
