// SPDX-License-Identifier: Apache-2.0
/// The edges from sixteen first vertices of paths to one second vertex, computed together.
#pragma once

#include "core/base/vectorized.h"
#include "core/interfaces/batch/lanes.h"
#include "core/math/rounding.h"
#include "core/scene/ray_queries.h"
#include "plugins/integrators/reusable_vertex.h"

#include <vector>

namespace lucerna {

/// First vertices, one array to each number. Vertices that are not set are joined to nothing.
class FirstVertices {
public:
    void set(std::size_t i, const ReusableVertex& vertex) {
        const Interaction& at = vertex.at;
        p.set(i, at.p);
        n.set(i, at.n);
        frame_s.set(i, at.shading.s);
        frame_t.set(i, at.shading.t);
        frame_n.set(i, at.shading.n);
        wo_local.set(i, vertex.wo_local);
        error[i] = at.error;
        in_medium[i] = vertex.in_medium() ? 1.0f : 0.0f;
        source[i] = at.source;
        if (materials_.empty()) {
            vertices_.fill(&vertex);
            points_.fill(&at);
        }
        vertices_[i] = &vertex;
        points_[i] = &at;
        add_to_material(i, vertex);
    }

    /// Values of what is at the vertices for the directions `wi` (local), in the lanes that are
    /// wanted.
    void evaluate(const LaneMask& wanted, const Vector3Lanes& wi, BSDFValueLanes& out) const {
        if (materials_.size() == 1) return evaluate(materials_.front(), wanted, wi, out);
        for (const Material& material : materials_) {
            LaneMask own;
            for (std::size_t i = 0; i < lane_count; ++i) own[i] = wanted[i] && material.lanes[i];
            BSDFValueLanes values;
            evaluate(material, own, wi, values);
            for (std::size_t i = 0; i < lane_count; ++i) {
                if (own[i]) out.set(i, {.f = values.f[i], .pdf = values.pdf[i]});
            }
        }
    }
    const ReusableVertex& operator[](std::size_t i) const { return *vertices_[i]; }

    Vector3Lanes p{}, n{}, frame_s{}, frame_t{}, frame_n{};
    Vector3Lanes wo_local{};  ///< towards the camera
    FloatLanes error{};
    FloatLanes in_medium{};  ///< 1 in a medium, 0 on a surface
    PrimitiveId source[lane_count];

private:
    /// A BSDF or a phase function.
    struct Material {
        const BSDF* bsdf;
        const Phase* phase;
        LaneMask lanes;
    };

    void evaluate(const Material& material, const LaneMask& wanted, const Vector3Lanes& wi,
                  BSDFValueLanes& out) const {
        if (material.phase) {
            return material.phase->batch().evaluate(*material.phase, p, wanted, wo_local, wi, out);
        }
        material.bsdf->batch().evaluate(*material.bsdf, points_, wanted, wo_local, wi,
                                        TransportMode::radiance, out);
    }

    void add_to_material(std::size_t i, const ReusableVertex& vertex) {
        auto material = std::find_if(materials_.begin(), materials_.end(), [&](const Material& m) {
            return m.bsdf == vertex.bsdf && m.phase == vertex.phase;
        });
        if (material == materials_.end()) {
            material = materials_.insert(material,
                                         {.bsdf = vertex.bsdf, .phase = vertex.phase, .lanes = {}});
        }
        material->lanes[i] = true;
    }

    // All valid once one is set.
    std::array<const ReusableVertex*, lane_count> vertices_;
    std::array<const Interaction*, lane_count> points_;
    std::vector<Material> materials_;
};

/// From each x to y; wi points to y.
struct Edges {
    Vector3Lanes wi_local;  ///< at x
    Vector3Lanes wo_local;  ///< at y, the opposite direction
    FloatLanes cosine;      ///< |cos θ_x|, or 1 if x is in a medium
    FloatLanes geometry;    ///< |cos θ_y| / d² [1/m²], or 1 / d² if y is in a medium
    ShadowPacket rays;      ///< open where light can go from y to x if nothing lies between
};

LUCERNA_VECTORIZED_INLINE inline void find_edges(const FirstVertices& x, const ReusableVertex& y,
                                                 Edges& edges) {
    const Frame frame = y.at.shading;
    const Vector3 y_p = y.at.p, y_n = y.at.n, viewed_n = y.viewed_n;
    const float y_error = y.at.error, y_side = y.wo_local.z;
    const float y_in_medium = y.in_medium() ? 1.0f : 0.0f;
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
        const float x_in_medium = x.in_medium[i];
        edges.cosine[i] = std::max(std::abs(wi_local.z), x_in_medium);
        edges.geometry[i] = std::max(std::abs(glm::dot(wi, y_n)), y_in_medium) / distance2;
        rays.o.set(i, origin);
        rays.d.set(i, offset_ray_origin(y_p, y_error, y_n, -wi) - origin);
        rays.tmax[i] = 1 - 1e-5f;
        const float seen_side = std::min(-glm::dot(wi, viewed_n), wo_local.z * y_side);
        const float own_side = glm::dot(wi, n) * wi_local.z;
        facing[i] = std::min(std::max(seen_side, y_in_medium), std::max(own_side, x_in_medium));
    }
    for (std::size_t i = 0; i < lane_count; ++i) {
        rays.open[i] = facing[i] > 0;
        rays.source[i] = x.source[i];
        rays.target[i] = y.at.source;
    }
}

}  // namespace lucerna
