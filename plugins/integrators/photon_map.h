// SPDX-License-Identifier: Apache-2.0
/// Photons that can be found by place.
#pragma once

#include "plugins/integrators/photon_grid.h"
#include "plugins/integrators/photon_kdtree.h"

#include <variant>

namespace lucerna {

enum class PhotonStructure { kdtree, grid };

class PhotonMap {
public:
    PhotonMap() = default;
    /// `emitted`: photons that have left the lights, whether stored or not. `radius` is the
    /// largest of any lookup.
    PhotonMap(std::vector<Photon> photons, double emitted, PhotonStructure structure, float radius,
              const Workers& workers)
        : radius_(radius), scale_(emitted > 0 ? static_cast<float>(1 / emitted) : 0) {
        if (structure == PhotonStructure::grid) {
            structure_.emplace<PhotonGrid>(photons, radius, workers);
        } else {
            structure_.emplace<PhotonKdTree>(std::move(photons), workers);
        }
    }

    const std::vector<Photon>& photons() const {
        return std::visit(
            [](const auto& s) -> const auto& { return s.photons(); }, structure_);
    }
    std::size_t bytes() const {
        return std::visit([](const auto& s) { return s.bytes(); }, structure_);
    }
    float radius() const { return radius_; }
    /// What Photon::power has to be multiplied by: one over the photons emitted.
    float scale() const { return scale_; }

    /// Calls visit(photon, distance²) for photons with distance² < radius2 around `p`; `visit` may
    /// make radius2 smaller. radius2 is at most the square of radius().
    template <typename Visit>
    void search(Vector3 p, float& radius2, Visit&& visit) const {
        std::visit([&](const auto& s) { s.search(p, radius2, visit); }, structure_);
    }

private:
    std::variant<PhotonKdTree, PhotonGrid> structure_;
    float radius_ = 0;
    float scale_ = 0;
};

}  // namespace lucerna
