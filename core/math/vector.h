// SPDX-License-Identifier: Apache-2.0
/// Vectors and colours. The only file that includes GLM.
///
/// The aliases say what a value means; GLM does not check it. Transforming a point, a direction
/// and a normal are three different named functions (transform.h).
#pragma once

#define GLM_FORCE_XYZW_ONLY
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace lucerna {

using Vector2 = glm::vec2;
using Vector3 = glm::vec3;
using Vector2d = glm::dvec2;
using Vector3d = glm::dvec3;
using Vector2i = glm::ivec2;
using Matrix3d = glm::dmat3;
using Matrix4d = glm::dmat4;

/// Linear RGB in the rendering space (linear Rec.709), one value per channel.
using Color = glm::vec3;
using ColorD = glm::dvec3;

inline constexpr float pi = std::numbers::pi_v<float>;
inline constexpr float inv_pi = std::numbers::inv_pi_v<float>;
inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// The largest float below one; every random number is clamped to it, so that [0, 1) holds.
inline constexpr float one_minus_epsilon = 0x1.fffffep-1f;

/// x², where writing x twice would hide that it is the same.
template <typename T>
constexpr T sqr(T x) {
    return x * x;
}

/// √max(x, 0): for expressions that only rounding makes negative.
inline float safe_sqrt(float x) { return std::sqrt(std::max(x, 0.0f)); }
inline double safe_sqrt(double x) { return std::sqrt(std::max(x, 0.0)); }

/// Relative luminance Y of a linear Rec.709 colour (ITU-R BT.709).
inline float luminance(Color c) { return 0.212639f * c.x + 0.715169f * c.y + 0.072192f * c.z; }

inline float max_component(Vector3 v) { return std::max(v.x, std::max(v.y, v.z)); }
inline float min_component(Vector3 v) { return std::min(v.x, std::min(v.y, v.z)); }

/// |x| of each component. glm::abs compares and branches, which random signs make slow.
inline Vector2 absolute(Vector2 v) { return {std::abs(v.x), std::abs(v.y)}; }
inline Vector3 absolute(Vector3 v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }
inline Vector3d absolute(Vector3d v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

inline bool is_black(Color c) { return c.x == 0 && c.y == 0 && c.z == 0; }

inline bool is_finite(Vector3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace lucerna
