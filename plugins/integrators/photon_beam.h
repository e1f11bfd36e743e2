// SPDX-License-Identifier: Apache-2.0
/// The beam radiance estimate (Jarosz, Zwicker and Jensen 2008, "The Beam Radiance Estimate for
/// Volumetric Photon Mapping"): light that a medium scatters towards the origin of a ray, from all
/// photons in whose sphere the ray is.
///
///     L(o, −d) ≈ Σ T(t_i) f(w_i, −d) Φ_i K(h_i / r_i) / r_i²
///
/// t_i is the place on the ray o + t d that is nearest to photon i, h_i their distance, T the
/// transmittance, f the phase function, r_i the radius of the photon and K a kernel on the unit
/// disk. Φ_i is power that is scattered already: there is no σs.
#pragma once

#include "core/math/bounds.h"
#include "core/scene/medium_tracking.h"
#include "plugins/integrators/photon_estimate.h"
#include "plugins/integrators/photon_kdtree.h"

#include <array>
#include <vector>

namespace lucerna {

/// The spheres of photons, as a hierarchy of boxes over the nodes of a k-d tree of their centres.
class BeamMap {
public:
    BeamMap() = default;
    /// `emitted`: photons that have left the lights. The radius of a photon is the distance of its
    /// `nearest`-th neighbour, at most `radius`; with `nearest` = 0 all have `radius`. `nearest` is
    /// less than PhotonLookup::max_count.
    BeamMap(std::vector<Photon> photons, double emitted, float radius, int nearest,
            const Workers& workers);

    bool empty() const { return leaves_.empty(); }
    /// What Photon::power has to be multiplied by: one over the photons emitted.
    float scale() const { return scale_; }

    /// Calls visit(photon, t, distance², radius²) for all photons to which a point of the ray is
    /// nearest that is not at its ends, 0 <= t <= length, and less than their radius away.
    template <typename Visit>
    void search(Vector3 o, Vector3 d, float length, Visit&& visit) const;

private:
    using Range = PhotonKdTree::Range;
    static constexpr std::size_t block = PhotonKdTree::block;
    /// Eight spheres, side by side for vector instructions. What is left over has a radius of zero.
    struct alignas(32) Leaf {
        std::array<float, block> x{}, y{}, z{}, radius2{};
    };

    float radius_of(const Photon& photon, float radius, int nearest) const;
    void fill_leaf(std::size_t index, float radius, int nearest);
    Bounds3 enclose(Range range);
    const Bounds3& box(Range range) const {
        return range.leaf() ? leaf_boxes_[range.begin] : inner_boxes_[range.middle()];
    }

    PhotonKdTree tree_;
    std::vector<Leaf> leaves_;
    std::vector<Bounds3> leaf_boxes_, inner_boxes_;
    float scale_ = 0;
};

inline BeamMap::BeamMap(std::vector<Photon> photons, double emitted, float radius, int nearest,
                        const Workers& workers)
    : tree_(std::move(photons), workers),
      scale_(emitted > 0 ? static_cast<float>(1 / emitted) : 0) {
    const std::size_t count = tree_.root().end;
    if (count == 0) return;
    leaves_.resize(count);
    leaf_boxes_.resize(count);
    inner_boxes_.resize(count);
    workers.run(static_cast<std::int64_t>(count),
                [&](std::int64_t i) { fill_leaf(static_cast<std::size_t>(i), radius, nearest); });
    enclose(tree_.root());
}

/// The photon itself is the nearest; photons at one point do not get a radius of zero.
inline float BeamMap::radius_of(const Photon& photon, float radius, int nearest) const {
    if (nearest == 0) return radius;
    constexpr float least = 1e-4f;
    float radius2 = sqr(radius);
    NearestPhotons found(nearest + 1);
    tree_.search(photon.p(), radius2, [&](const Photon& other, float distance2) {
        found.add({distance2, &other});
        if (found.full()) radius2 = found.farthest2();
    });
    return std::max(std::sqrt(radius2), least * radius);
}

inline void BeamMap::fill_leaf(std::size_t index, float radius, int nearest) {
    const std::vector<Photon>& photons = tree_.photons();
    const std::size_t first = index * block;
    for (std::size_t i = 0; i < std::min(block, photons.size() - first); ++i) {
        const Vector3 p = photons[first + i].p();
        const float r = radius_of(photons[first + i], radius, nearest);
        Leaf& leaf = leaves_[index];
        leaf.x[i] = p.x, leaf.y[i] = p.y, leaf.z[i] = p.z;
        leaf.radius2[i] = sqr(r);
        leaf_boxes_[index].include(p - r);
        leaf_boxes_[index].include(p + r);
    }
}

/// The box of a node, after those below it.
inline Bounds3 BeamMap::enclose(Range range) {
    if (range.leaf()) return leaf_boxes_[range.begin];
    Bounds3& box = inner_boxes_[range.middle()];
    box = enclose({range.begin, range.middle()});
    box.include(enclose({range.middle(), range.end}));
    return box;
}

/// What of a line is in a box (slabs: Kay and Kajiya 1986), slightly enlarged against rounding.
class LineInBox {
public:
    LineInBox(Vector3 o, Vector3 d, float length) : o_(o), length_(length) {
        constexpr float tiny = 1e-18f;  // 0 · ∞ would be NaN
        for (int axis = 0; axis < 3; ++axis) {
            const float x = d[axis];
            inverse_[axis] = 1 / (std::abs(x) > tiny ? x : std::copysign(tiny, x));
        }
    }
    bool meets(const Bounds3& box) const {
        const Vector3 a = (box.min - o_) * inverse_, b = (box.max - o_) * inverse_;
        const Vector3 near = glm::min(a, b), far = glm::max(a, b);
        const float begin = std::max({near.x, near.y, near.z, 0.0f});
        const float end = std::min({far.x, far.y, far.z});
        return begin <= std::min(end * (1 + 2 * gamma(3)), length_);
    }

private:
    Vector3 o_, inverse_{0};
    float length_;
};

template <typename Visit>
void BeamMap::search(Vector3 o, Vector3 d, float length, Visit&& visit) const {
    if (empty()) return;
    const LineInBox line(o, d, length);
    Range stack[64];
    int size = 0;
    stack[size++] = tree_.root();
    while (size > 0) {
        const Range range = stack[--size];
        if (!line.meets(box(range))) continue;
        if (!range.leaf()) {
            stack[size++] = {range.middle(), range.end};
            stack[size++] = {range.begin, range.middle()};
            continue;
        }
        const Leaf& leaf = leaves_[range.begin];
        std::array<float, block> t, distance2;
        for (std::size_t i = 0; i < block; ++i) {
            const float x = leaf.x[i] - o.x, y = leaf.y[i] - o.y, z = leaf.z[i] - o.z;
            t[i] = x * d.x + y * d.y + z * d.z;
            distance2[i] = sqr(x - t[i] * d.x) + sqr(y - t[i] * d.y) + sqr(z - t[i] * d.z);
        }
        for (std::size_t i = 0; i < block; ++i) {
            const bool on_ray = t[i] >= 0 && t[i] <= length;
            if (!on_ray || !(distance2[i] < leaf.radius2[i])) continue;
            visit(tree_.photons()[range.begin * block + i], t[i], distance2[i], leaf.radius2[i]);
        }
    }
}

/// Radiance towards the origin of the segment from photons with up to `lookup.max_depth` edges,
/// whichever medium they are in: a scene may state the same fog twice. `arriving` tells how much
/// gets through the medium.
inline Color beam_radiance(const BeamMap& map, const PhotonLookup& lookup,
                           const MediumSegment& segment, const TransmittanceAlong& arriving) {
    Color sum(0);
    const Phase& phase = segment.medium->phase();
    map.search(segment.o, segment.d, segment.length,
               [&](const Photon& photon, float t, float distance2, float radius2) {
                   if (photon.depth() > lookup.max_depth) return;
                   const float f = phase.evaluate(photon.p(), photon.direction(), -segment.d).f;
                   const float kernel = photon_kernel(lookup.filter, distance2 / radius2);
                   sum += arriving(t) * photon.power() * (f * kernel / radius2);
               });
    return sum * map.scale();
}

}  // namespace lucerna
