// SPDX-License-Identifier: Apache-2.0
/// The edges from sixteen first vertices of paths to one second vertex, computed together.
#pragma once

#include "core/base/vectorized.h"
#include "core/interfaces/batch/lanes.h"
#include "core/math/rounding.h"
#include "core/scene/ray_queries.h"
#include "plugins/integrators/light_sampling.h"

#include <vector>

namespace lucerna {

/// First vertices, one array to each number. Vertices that are not set are joined to nothing.
class FirstVertices {
public:
    void set(std::size_t i, const LitSurface& vertex) {
        const Interaction& at = vertex.at;
        p.set(i, at.p);
        n.set(i, at.n);
        frame_s.set(i, at.shading.s);
        frame_t.set(i, at.shading.t);
        frame_n.set(i, at.shading.n);
        wo_local.set(i, vertex.wo_local);
        error[i] = at.error;
        source[i] = at.source;
        if (materials_.empty()) points_.fill(&at);
        points_[i] = &at;
        add_to_material(i, vertex.bsdf);
    }

    /// Values of the BSDFs at the vertices for the directions `wi` (local), in the lanes that are
    /// wanted.
    void evaluate(const LaneMask& wanted, const Vector3Lanes& wi, BSDFValueLanes& out) const {
        constexpr TransportMode mode = TransportMode::radiance;
        if (materials_.size() == 1) {
            const BSDF& bsdf = *materials_.front().bsdf;
            return bsdf.batch().evaluate(bsdf, points_, wanted, wo_local, wi, mode, out);
        }
        for (const Material& material : materials_) {
            LaneMask own;
            for (std::size_t i = 0; i < lane_count; ++i) own[i] = wanted[i] && material.lanes[i];
            BSDFValueLanes values;
            material.bsdf->batch().evaluate(*material.bsdf, points_, own, wo_local, wi, mode,
                                            values);
            for (std::size_t i = 0; i < lane_count; ++i) {
                if (own[i]) out.set(i, {.f = values.f[i], .pdf = values.pdf[i]});
            }
        }
    }

    Vector3Lanes p{}, n{}, frame_s{}, frame_t{}, frame_n{};
    Vector3Lanes wo_local{};  ///< towards the camera
    FloatLanes error{};
    PrimitiveId source[lane_count];

private:
    struct Material {
        const BSDF* bsdf;
        LaneMask lanes;
    };

    void add_to_material(std::size_t i, const BSDF& bsdf) {
        auto material = std::find_if(materials_.begin(), materials_.end(),
                                     [&](const Material& m) { return m.bsdf == &bsdf; });
        if (material == materials_.end()) {
            material = materials_.insert(material, {.bsdf = &bsdf, .lanes = {}});
        }
        material->lanes[i] = true;
    }

    std::array<const Interaction*, lane_count> points_;  ///< all valid once one is set
    std::vector<Material> materials_;
};

/// From each x to y; wi points to y.
struct Edges {
    Vector3Lanes wi_local;  ///< at x
    Vector3Lanes wo_local;  ///< at y, the opposite direction
    FloatLanes geometry;    ///< |cos θ_y| / d² [1/m²]
    ShadowPacket rays;      ///< open where light can go from y to x if nothing lies between
};

LUCERNA_VECTORIZED_INLINE inline void find_edges(const FirstVertices& x, const LitSurface& y,
                                                 Edges& edges) {
    const Frame frame = y.at.shading;
    const Vector3 y_p = y.at.p, y_n = y.at.n, viewed_n = y.receiver.n;
    const float y_error = y.at.error, y_side = y.wo_local.z;
    ShadowPacket& rays = edges.rays;
    FloatLanes facing;  // positive: light can go
    for (std::size_t i = 0; i < lane_count; ++i) {
        const Vector3 p = x.p[i], n = x.n[i];
        const Vector3 d = y_p - p;
        const float distance2 = glm::dot(d, d);
        const Vector3 wi = d / std::sqrt(distance2);
        const Vector3 wi_local = Frame{x.frame_s[i], x.frame_t[i], x.frame_n[i]}.to_local(wi);
        const Vector3 wo_local = frame.to_local(-wi);
        const Vector3 origin = offset_ray_origin(p, x.error[i], n, wi);
        edges.wi_local.set(i, wi_local);
        edges.wo_local.set(i, wo_local);
        edges.geometry[i] = std::abs(glm::dot(wi, y_n)) / distance2;
        rays.o.set(i, origin);
        rays.d.set(i, offset_ray_origin(y_p, y_error, y_n, -wi) - origin);
        rays.tmax[i] = 1 - 1e-5f;
        const float seen_side = std::min(-glm::dot(wi, viewed_n), wo_local.z * y_side);
        facing[i] = std::min(seen_side, glm::dot(wi, n) * wi_local.z);
    }
    for (std::size_t i = 0; i < lane_count; ++i) {
        rays.open[i] = facing[i] > 0;
        rays.source[i] = x.source[i];
        rays.target[i] = y.at.source;
    }
}

}  // namespace lucerna
