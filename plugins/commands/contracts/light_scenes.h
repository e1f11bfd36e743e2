// SPDX-License-Identifier: Apache-2.0
/// Scenes, as text, in which light samplers are tried, and points of them.
#pragma once

#include "core/scene/scene.h"

#include <string>
#include <vector>

namespace lucerna::contracts {

/// What stands between `<scene>` and `</scene>`: lights of all kinds and of very different powers
/// over a floor; all lengths are multiplied by `size`.
std::string many_lights(double size = 1);
/// Points and normals all over that scene, some of them on lights or at their centres.
std::vector<Receiver> scattered_points(int count, float size = 1);

/// Blocks on a floor between lamps, half of which are hidden, under a dim sky; with a camera of
/// `width`² pixels. `integrator` comes first.
std::string courtyard(const std::string& integrator, int width = 16);
/// Points that the camera sees, and what is seen from there; light can go to their front.
std::vector<Receiver> seen_points(const Scene& scene, int count, std::uint64_t seed);

}  // namespace lucerna::contracts
