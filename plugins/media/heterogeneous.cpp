// SPDX-License-Identifier: Apache-2.0
/// heterogeneous: a medium whose coefficients vary in space, such as smoke or a cloud.
///
/// It ends where one of its volumes ends. Light is followed below the majorants of a coarse grid,
/// whose cells hold several voxels each.
#include "plugins/media/coefficients.h"

#include <fmt/format.h>

#include <optional>

namespace lucerna {
namespace {

class Heterogeneous final : public Medium {
public:
    explicit Heterogeneous(const Params& params) : Medium(params), coefficients_(params) {
        if (coefficients_.constant() && phase().uniform()) return;
        const Bounds3 box = coefficients_.bounds();
        if (box.empty()) {
            throw Error(
                "the volumes of a heterogeneous medium share no point of the world: it would be "
                "empty");
        }
        if (!is_finite(box.min) || !is_finite(box.max)) {
            throw Error("one of the volumes of a heterogeneous medium must have bounds");
        }
        const glm::ivec3 size =
            glm::clamp(coefficients_.resolution() / voxels_per_cell, glm::ivec3(1), glm::ivec3(64));
        grid_.emplace(box, size, [&](const Bounds3& cell) {
            // Emission is met at collisions, even where there is no extinction.
            const float length = max_component(cell.extent());
            const float emits = coefficients_.max_emission(cell) > 0 ? 1 / length : 0.0f;
            const float area = phase().max_projected_area(cell);
            const float majorant = std::max(area * coefficients_.max_extinction(cell), emits);
            check_majorant(majorant, length);
            return majorant;
        });
    }

    const MajorantGrid* majorants() const override { return grid_ ? &*grid_ : nullptr; }
    bool emits() const override { return coefficients_.emits(); }

private:
    MediumPoint coefficients(Vector3 p) const override { return coefficients_.at(p); }

    static constexpr int voxels_per_cell = 4;

    /// Tentative collisions in a cell are as many as its majorant is large, whatever is there.
    static void check_majorant(float majorant, float length) {
        constexpr float most_collisions = 1e6f;
        if (!std::isfinite(majorant)) throw Error("the extinction of a medium must be finite");
        if (majorant * length <= most_collisions) return;
        throw Error(fmt::format(
            "the extinction of this medium reaches {:g}, in a cell of length {:g}: a ray would "
            "take up to {:g} steps there, but {:g} is the most; use a smaller scale, or a surface",
            majorant, length, majorant * length, most_collisions));
    }

    MediumCoefficients coefficients_;
    std::optional<MajorantGrid> grid_;
};

}  // namespace

const PluginInfo plugin = describe<Heterogeneous>("varies in space: smoke, clouds, fire");

}  // namespace lucerna
