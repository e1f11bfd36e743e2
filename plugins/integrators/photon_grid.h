// SPDX-License-Identifier: Apache-2.0
/// A hash grid of photons for lookups within one radius (Teschner et al. 2003).
///
/// Cells are twice the radius wide, so a lookup meets eight of them. Photons are sorted by the
/// bucket of their cell (counting sort); cells that follow each other along x have buckets that
/// follow each other in memory.
#pragma once

#include "core/base/parallel.h"
#include "core/math/sequences.h"
#include "plugins/integrators/photon.h"

#include <bit>
#include <vector>

namespace lucerna {

class PhotonGrid {
public:
    PhotonGrid() = default;
    /// `radius` > 0 is the largest that `search` may be asked for.
    PhotonGrid(const std::vector<Photon>& photons, float radius, const Workers& workers);

    const std::vector<Photon>& photons() const { return photons_; }
    std::size_t bytes() const {
        return photons_.capacity() * sizeof(Photon) + starts_.capacity() * sizeof(std::uint32_t);
    }

    /// As PhotonKdTree::search, in no particular order.
    template <typename Visit>
    void search(Vector3 p, float& radius2, Visit&& visit) const;

private:
    /// Clamped, so that a tiny radius in a huge scene stays defined: the rim shares cells.
    static std::int64_t clamped(double cell) {
        return static_cast<std::int64_t>(std::clamp(std::floor(cell), -0x1p52, 0x1p52));
    }
    static std::uint64_t row(std::int64_t y, std::int64_t z) {
        return mix64(static_cast<std::uint64_t>(y) +
                     mix64(static_cast<std::uint64_t>(z) + 0x9e3779b97f4a7c15u));
    }
    std::uint32_t bucket(std::uint64_t row, std::int64_t x) const {
        return static_cast<std::uint32_t>(row + static_cast<std::uint64_t>(x)) & mask_;
    }

    std::vector<Photon> photons_;
    std::vector<std::uint32_t> starts_;  ///< bucket b holds photons starts_[b] … starts_[b + 1] − 1
    double width_ = 1;
    std::uint32_t mask_ = 0;
};

inline PhotonGrid::PhotonGrid(const std::vector<Photon>& photons, float radius,
                              const Workers& workers)
    : width_(2 * static_cast<double>(radius)) {
    if (photons.empty()) return;
    const std::size_t buckets = std::bit_ceil(photons.size());
    mask_ = static_cast<std::uint32_t>(buckets - 1);
    std::vector<std::uint32_t> keys(photons.size());
    constexpr std::size_t chunk = 1 << 14;
    const auto chunks = static_cast<std::int64_t>((photons.size() + chunk - 1) / chunk);
    workers.run(chunks, [&](std::int64_t c) {
        const std::size_t begin = static_cast<std::size_t>(c) * chunk;
        for (std::size_t i = begin; i < std::min(begin + chunk, photons.size()); ++i) {
            const Vector3d q = Vector3d(photons[i].p()) / width_;
            keys[i] = bucket(row(clamped(q.y), clamped(q.z)), clamped(q.x));
        }
    });
    // Counts, then ends; filling from the back turns them into starts and keeps the order.
    starts_.assign(buckets + 1, 0);
    for (const std::uint32_t key : keys) ++starts_[key];
    for (std::size_t b = 1; b <= buckets; ++b) starts_[b] += starts_[b - 1];
    photons_.resize(photons.size());
    for (std::size_t i = photons.size(); i-- > 0;) photons_[--starts_[keys[i]]] = photons[i];
}

template <typename Visit>
void PhotonGrid::search(Vector3 p, float& radius2, Visit&& visit) const {
    if (photons_.empty()) return;
    const Vector3d q = Vector3d(p) / width_ - 0.5;
    const std::int64_t x = clamped(q.x), y = clamped(q.y), z = clamped(q.z);
    std::uint32_t seen[8];
    int count = 0;
    for (int i = 0; i < 8; ++i) {
        const std::uint32_t b = bucket(row(y + (i >> 1 & 1), z + (i >> 2)), x + (i & 1));
        // Two cells may share a bucket: its photons must not count twice.
        if (std::find(seen, seen + count, b) != seen + count) continue;
        seen[count++] = b;
        for (std::uint32_t j = starts_[b]; j < starts_[b + 1]; ++j) {
            const Vector3 v = photons_[j].p() - p;
            const float distance2 = glm::dot(v, v);
            if (distance2 < radius2) visit(photons_[j], distance2);
        }
    }
}

}  // namespace lucerna
