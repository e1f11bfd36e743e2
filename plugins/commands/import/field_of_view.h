// SPDX-License-Identifier: Apache-2.0
/// The field of view of a model's camera.
#pragma once

#include <assimp/scene.h>

namespace lucerna {

/// [radians], for a picture of this width over height; `gltf`: the model is one.
double horizontal_fov(const aiCamera& camera, double aspect, bool gltf);

}  // namespace lucerna
