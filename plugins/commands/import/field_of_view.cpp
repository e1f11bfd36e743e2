// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/field_of_view.h"

#include <assimp/Importer.hpp>

#include <cmath>
#include <string_view>

namespace lucerna {

namespace {

/// True if this assimp multiplies the angles of glTF cameras by their aspect ratio, as 5.2 does,
/// where it should multiply their tangents: it is asked with a camera of 1 radian and aspect 2.
bool assimp_multiplies_angles() {
    constexpr std::string_view model =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"camera":0}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"aspectRatio":2,"znear":0.1}}]})";
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(model.data(), model.size(), 0, "gltf");
    return scene && scene->mNumCameras == 1 &&
           std::abs(scene->mCameras[0]->mHorizontalFOV - 2) < 1e-3f;
}

}  // namespace

double horizontal_fov(const aiCamera& camera, double aspect, bool gltf) {
    const double given = static_cast<double>(camera.mHorizontalFOV);
    if (!gltf) return given;
    const double known = camera.mAspect > 0 ? static_cast<double>(camera.mAspect) : 1;
    const double half =
        assimp_multiplies_angles() ? std::tan(0.5 * given / known) : std::tan(0.5 * given) / known;
    return 2 * std::atan(half * aspect);
}

}  // namespace lucerna
