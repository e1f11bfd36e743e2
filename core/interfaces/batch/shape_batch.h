// SPDX-License-Identifier: Apache-2.0
/// Sixteen points on a shape at once: see bsdf_batch.h. T may have the functions
/// `sample_area_lanes` and `prefetch`.
#pragma once

#include "core/interfaces/batch/lanes.h"

namespace lucerna {

class Shape;

struct ShapeBatch {
    enum class Prefetch { addresses, data };

    /// As Shape::sample_area, in the first `count` lanes. All lanes of `u` hold numbers of [0, 1)².
    void (*sample_area)(const Shape& shape, std::uint32_t primitive, const Vector2Lanes& u,
                        std::size_t count, SurfaceSampleLanes& out);
    /// Prefetches a primitive: first its indices, then, when they have arrived, its data. Called
    /// only for shapes that the nearest cache does not hold.
    void (*prefetch)(const Shape& shape, std::uint32_t primitive, Prefetch what);

    template <typename T>
    static void attach(T& object) {
        static constexpr ShapeBatch loops{.sample_area = sample_area_each<T>,
                                          .prefetch = prefetch_one<T>};
        object.batch_ = &loops;
    }

    /// Shape::sample_area point by point.
    template <typename T>
    static void sample_area_one_by_one(const T& shape, std::uint32_t primitive,
                                       const Vector2Lanes& u, std::size_t count,
                                       SurfaceSampleLanes& out) {
        for (std::size_t i = 0; i < count; ++i) out.set(i, shape.sample_area(primitive, u[i]));
    }

private:
    template <typename T>
    static void prefetch_one(const Shape& shape, std::uint32_t primitive, Prefetch what) {
        const T& it = static_cast<const T&>(shape);
        if constexpr (requires { it.prefetch(primitive, what); }) it.prefetch(primitive, what);
    }

    template <typename T>
    static void sample_area_each(const Shape& shape, std::uint32_t primitive, const Vector2Lanes& u,
                                 std::size_t count, SurfaceSampleLanes& out) {
        const T& it = static_cast<const T&>(shape);
        if constexpr (requires { it.sample_area_lanes(primitive, u, count, out); }) {
            it.sample_area_lanes(primitive, u, count, out);
        } else {
            sample_area_one_by_one(it, primitive, u, count, out);
        }
    }
};

}  // namespace lucerna
