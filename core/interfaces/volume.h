// SPDX-License-Identifier: Apache-2.0
/// A quantity in space, colours, numbers or matrices, and the input through which plugins read it.
///
/// Points and boxes are in world space. A volume ends at its bounds: nobody asks outside of them.
#pragma once

#include "core/math/bounds.h"
#include "core/math/symmetric_matrix.h"
#include "core/plugin/plugin.h"

namespace lucerna {

class Volume : public Object {
public:
    static constexpr const char* kind = "volume";
    ~Volume() override;

    /// Linear Rec.709 (or raw data) at `p`; a volume of one number repeats it.
    virtual Color color(Vector3 p) const = 0;
    /// One number: the luminance of a colour, of raw data, too.
    virtual float real(Vector3 p) const = 0;
    /// Whether its values are matrices, zero or positive definite: then nobody asks for others.
    virtual bool has_matrices() const { return false; }
    virtual SymmetricMatrix matrix([[maybe_unused]] Vector3 p) const { return {}; }

    /// The box that holds the volume; infinite, without a NaN, if it is everywhere.
    virtual Bounds3 bounds() const = 0;
    /// Number of voxels along x, y and z of `bounds()`, as good as that can be said if the grid is
    /// turned against the axes of the world; 1 if nothing varies.
    virtual glm::ivec3 resolution() const { return glm::ivec3(1); }
    /// No channel of `color`, or eigenvalue of `matrix`, is larger at any point of the box: for
    /// local majorants. The box may reach beyond the volume.
    virtual float max(const Bounds3& box) const = 0;
};

/// A colour or number that is the same everywhere or a volume; a constant costs no call.
struct VolumeInput {
    Color constant{0};
    const Volume* volume = nullptr;

    Color color(Vector3 p) const { return volume ? volume->color(p) : constant; }
    float real(Vector3 p) const { return volume ? volume->real(p) : luminance(constant); }
    float max(const Bounds3& box) const {
        return volume ? volume->max(box) : max_component(constant);
    }
    Bounds3 bounds() const {
        return volume ? volume->bounds()
                      : Bounds3{.min = Vector3(-infinity), .max = Vector3(infinity)};
    }
    glm::ivec3 resolution() const { return volume ? volume->resolution() : glm::ivec3(1); }
};

}  // namespace lucerna
