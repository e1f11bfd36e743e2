// SPDX-License-Identifier: Apache-2.0
/// What fills space and scatters, absorbs or emits light: fog, smoke, glass.
///
/// Coefficients are per unit of length of the scene [1/m] and for each channel. Those of oriented
/// particles (phase.h) depend on the direction of light. A medium is either the same everywhere, or
/// varies below majorants (core/math/majorant_grid.h): numbers that no channel's extinction exceeds
/// in a cell of a coarse grid. Outside of that grid it is empty.
#pragma once

#include "core/interfaces/phase.h"
#include "core/math/majorant_grid.h"

namespace lucerna {

/// What a medium does at one point.
struct MediumPoint {
    Color sigma_s{0};   ///< scattering [1/m]; at most sigma_t
    Color sigma_t{0};   ///< extinction: scattering and absorption [1/m]
    Color emission{0};  ///< radiance that is emitted for each unit of length [W/(m³ sr)]
};

class Medium : public Object {
public:
    static constexpr const char* kind = "medium";
    /// Reads what all media have: the nested phase function.
    explicit Medium(const Params& params);
    ~Medium() override;

    /// At a point of the world, inside of the majorants' grid if there is one, for light along the
    /// unit vector `w`, either way.
    MediumPoint at(Vector3 p, Vector3 w) const {
        return oriented_ ? turned(p, w) : coefficients(p);
    }
    /// Null if the medium is the same at every point.
    virtual const MajorantGrid* majorants() const { return nullptr; }
    /// Whether it emits anywhere.
    virtual bool emits() const { return false; }

    bool homogeneous() const { return majorants() == nullptr; }
    const Phase& phase() const { return *phase_; }
    /// False if it is known to scatter nowhere.
    bool may_scatter() const {
        return !homogeneous() || coefficients(Vector3(0)).sigma_s != Color(0);
    }

private:
    /// At a point of the world, for particles whose projected area is 1.
    virtual MediumPoint coefficients(Vector3 p) const = 0;
    MediumPoint turned(Vector3 p, Vector3 w) const;

    const Phase* phase_;
    bool oriented_;
};

/// The media on both sides of a surface; null is empty space. A path that crosses a surface with
/// media is then in the medium on the side to which it goes, by the geometric normal: whatever it
/// was in before.
struct MediumInterface {
    const Medium* interior = nullptr;  ///< opposite to the normal
    const Medium* exterior = nullptr;  ///< on the side of the normal

    /// Whether the surface changes the medium at all; if not, paths stay in theirs.
    explicit operator bool() const { return interior || exterior; }
    /// The medium into which a direction leads, where `n` is the geometric normal.
    const Medium* beyond(Vector3 n, Vector3 d) const {
        return glm::dot(n, d) > 0 ? exterior : interior;
    }
};

}  // namespace lucerna
