// SPDX-License-Identifier: Apache-2.0
/// Radiance from the density of photons (Jensen 1996, "Global Illumination using Photon Maps").
///
///     L(p, wo) ≈ Σ f(wo, w_i) Φ_i K(d_i / r) / r²
///
/// There is no cosine: the power of photons per area is irradiance already.
#pragma once

#include "core/scene/scatter.h"
#include "plugins/integrators/photon_map.h"

#include <array>
#include <span>

namespace lucerna {

enum class PhotonFilter { none, cone, gaussian };

/// K at squared distance t² <= 1: its integral over the unit disk is exactly one.
inline float photon_kernel(PhotonFilter filter, float t2) {
    switch (filter) {
        case PhotonFilter::none:
            return inv_pi;
        case PhotonFilter::cone:
            return 3 * inv_pi * (1 - std::sqrt(t2));
        case PhotonFilter::gaussian:
            break;
    }
    // Jensen's Gaussian 1 − (1 − e^(−βt²/2)) / (1 − e^(−β)) with β = 1.953; over the disk it
    // integrates to π (1 − (1 − 2 (1 − e^(−β/2)) / β) / (1 − e^(−β))). His factor 0.918, meant for
    // another filter, would lose 47 % of the light.
    constexpr float beta = 1.953f;
    constexpr float rim = 0.858152111f;       // 1 − e^(−β)
    constexpr float integral = 0.578600397f;  // over π
    const float fall = 1 - std::exp(-0.5f * beta * t2);
    return (inv_pi / integral) * (1 - fall / rim);
}

/// Which photons count.
struct PhotonLookup {
    static constexpr int max_count = 1024;

    int count = 0;  ///< the nearest ones that count, at most max_count; 0: all within the radius
    float least_radius = 0;  ///< within which all count, even if they are more
    PhotonFilter filter = PhotonFilter::cone;
    int max_depth = 0;  ///< of a photon
};

/// The point that is looked at, and which photons can light it.
class PhotonReceiver {
public:
    PhotonReceiver(const BSDF& bsdf, const Interaction& at, Vector3 wo)
        : bsdf_(bsdf),
          at_(at),
          wo_(at.to_local(wo)),
          n_(glm::dot(wo, at.n) < 0 ? -at.n : at.n),
          both_sides_(bsdf.sides() == Sides::both) {}

    const Interaction& at() const { return at_; }

    /// The squared distance of a photon at the squared distance `d2`, enlarged across the surface:
    /// the ball becomes a thin disk, so that light does not leak around corners or through walls.
    /// Infinite for photons on surfaces that face elsewhere.
    float distance2(const Photon& photon, float d2) const {
        constexpr float least_cosine = 0.5f, stretch2 = 5 * 5;
        const float cosine = glm::dot(photon.normal(), n_);
        if ((both_sides_ ? std::abs(cosine) : cosine) < least_cosine) return infinity;
        return d2 + (stretch2 - 1) * sqr(glm::dot(photon.p() - at_.p, n_));
    }

    /// Radiance towards the viewer for each unit of irradiance that the photon brings. Irradiance
    /// is measured on the surface itself; f expects it on the plane of the shading normal.
    Color reflected(const Photon& photon) const {
        const Vector3 w = photon.direction();
        const Vector3 wi = at_.to_local(w);
        const float geometric = glm::dot(w, at_.n);
        if (!(geometric * wi.z > 0)) return Color(0);
        return bsdf_.evaluate(at_, wo_, wi, TransportMode::radiance).f * (wi.z / geometric) *
               photon.power();
    }

private:
    const BSDF& bsdf_;
    const Interaction& at_;
    Vector3 wo_, n_;
    bool both_sides_;
};

/// The nearest photons, as a heap with the farthest on top.
class NearestPhotons {
public:
    struct Found {
        float distance2;
        const Photon* photon;
    };

    explicit NearestPhotons(int count) : capacity_(count) {}

    bool full() const { return size_ == capacity_; }
    float farthest2() const { return heap_[0].distance2; }
    std::span<const Found> all() const { return {heap_.data(), static_cast<std::size_t>(size_)}; }

    /// Once it is full, `found` must be nearer than the farthest, which it replaces.
    void add(Found found) {
        if (size_ < capacity_) {
            heap_[static_cast<std::size_t>(size_++)] = found;
            if (size_ == capacity_) {
                std::make_heap(heap_.begin(), heap_.begin() + size_, nearer);
            }
            return;
        }
        int hole = 0;
        for (int child = 1; child < size_; child = 2 * hole + 1) {
            if (child + 1 < size_ && nearer(at(child), at(child + 1))) ++child;
            if (!(found.distance2 < at(child).distance2)) break;
            heap_[static_cast<std::size_t>(hole)] = at(child);
            hole = child;
        }
        heap_[static_cast<std::size_t>(hole)] = found;
    }

private:
    static bool nearer(const Found& a, const Found& b) { return a.distance2 < b.distance2; }
    const Found& at(int i) const { return heap_[static_cast<std::size_t>(i)]; }

    std::array<Found, PhotonLookup::max_count> heap_;  // not initialised: it is large
    int capacity_, size_ = 0;
};

/// Radiance that leaves towards the viewer, from all within a radius, at most that of the map.
inline Color radiance_within(const PhotonMap& map, float radius, const PhotonLookup& lookup,
                             const PhotonReceiver& receiver) {
    float radius2 = sqr(radius);
    const float limit2 = radius2;
    Color sum(0);
    map.search(receiver.at().p, radius2, [&](const Photon& photon, float d2) {
        if (photon.depth() > lookup.max_depth) return;
        const float distance2 = receiver.distance2(photon, d2);
        if (!(distance2 < limit2)) return;
        sum += receiver.reflected(photon) * photon_kernel(lookup.filter, distance2 / limit2);
    });
    return sum * (map.scale() / limit2);
}

/// As above, from the nearest `lookup.count` photons. The farthest gives the radius and is not
/// counted itself: only so is the estimate right on average, since the mean of 1 / A_k is
/// density / (k − 1). That stays so where the radius is bounded, on both sides: up to any radius,
/// the density is counted with the probability that k − 1 photons or more are within.
inline Color radiance_nearest(const PhotonMap& map, const PhotonLookup& lookup,
                              const PhotonReceiver& receiver) {
    float radius2 = sqr(map.radius());
    // Photons at one point have infinite density, which is not drawn.
    const float least_radius2 = 1e-8f * radius2;
    NearestPhotons nearest(lookup.count);
    map.search(receiver.at().p, radius2, [&](const Photon& photon, float d2) {
        if (photon.depth() > lookup.max_depth) return;
        const float distance2 = receiver.distance2(photon, d2);
        if (!(distance2 < radius2)) return;
        nearest.add({distance2, &photon});
        if (nearest.full()) radius2 = nearest.farthest2();
    });
    if (nearest.full() && radius2 < sqr(lookup.least_radius)) {
        return radiance_within(map, lookup.least_radius, lookup, receiver);
    }
    auto counted = nearest.all();
    if (nearest.full()) counted = counted.subspan(1);
    const float used2 = std::max(radius2, least_radius2);
    Color sum(0);
    for (const auto& [distance2, photon] : counted) {
        sum += receiver.reflected(*photon) * photon_kernel(lookup.filter, distance2 / used2);
    }
    return sum * (map.scale() / used2);
}

inline Color photon_radiance(const PhotonMap& map, const PhotonLookup& lookup, const BSDF& bsdf,
                             const Interaction& at, Vector3 wo) {
    if (map.photons().empty() || !same_side(at, wo, at.to_local(wo))) return Color(0);
    const PhotonReceiver receiver(bsdf, at, wo);
    return lookup.count > 0 ? radiance_nearest(map, lookup, receiver)
                            : radiance_within(map, map.radius(), lookup, receiver);
}

}  // namespace lucerna
