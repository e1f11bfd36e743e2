// SPDX-License-Identifier: Apache-2.0
/// A picture as the page of a preview gets it: linear, and no larger than a screen.
#pragma once

#include "core/image/image.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

namespace lucerna {

/// Means over squares of `factor` × `factor` pixels, cut off at the right and lower edges.
inline Image reduced(const Image& image, int factor) {
    Image result((image.width + factor - 1) / factor, (image.height + factor - 1) / factor);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            const Vector2i begin = factor * Vector2i(x, y);
            const Vector2i end = glm::min(begin + factor, Vector2i(image.width, image.height));
            Color sum(0);
            for (int v = begin.y; v < end.y; ++v) {
                for (int u = begin.x; u < end.x; ++u) sum += image.rgb(u, v);
            }
            const Vector2i size = end - begin;
            result.set_rgb(x, y, sum / static_cast<float>(size.x * size.y));
        }
    }
    return result;
}

/// Width and height (uint32), then R, G and B of all pixels (float), little endian; reduced by a
/// whole factor if a side is longer than `largest_side`.
inline std::string reduced_picture_bytes(const Image& image, int largest_side) {
    const int side = std::max(image.width, image.height);
    const int factor = (side + largest_side - 1) / largest_side;
    if (factor > 1) return reduced_picture_bytes(reduced(image, factor), largest_side);
    const std::uint32_t size[2] = {static_cast<std::uint32_t>(image.width),
                                   static_cast<std::uint32_t>(image.height)};
    std::string bytes(sizeof size + image.pixels.size() * sizeof(float), '\0');
    std::memcpy(bytes.data(), size, sizeof size);
    std::memcpy(bytes.data() + sizeof size, image.pixels.data(),
                image.pixels.size() * sizeof(float));
    return bytes;
}

}  // namespace lucerna
