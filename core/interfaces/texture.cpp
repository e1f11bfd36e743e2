// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/texture.h"

namespace lucerna {

Texture::~Texture() = default;

Vector2 Texture::gradient(Vector2 uv) const {
    constexpr float step = 0x1p-10f;  // a power of two: uv ± step are exact in the unit square
    const float along_u = real(uv + Vector2(step, 0)) - real(uv - Vector2(step, 0));
    const float along_v = real(uv + Vector2(0, step)) - real(uv - Vector2(0, step));
    return Vector2(along_u, along_v) / (2 * step);
}

}  // namespace lucerna
