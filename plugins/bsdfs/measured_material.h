// SPDX-License-Identifier: Apache-2.0
/// A material of the RGL database: what its file holds, and the BRDF that follows from it
/// (Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and
/// Rendering").
///
/// A direction (θ, φ) lies at (√(2θ/π), (φ + π) / 2π) in the unit square. For each direction ωi
/// that was measured, the density of visible normals `vndf` maps a point s of the square to a
/// normal ωm; what was measured at s, with the cosine of ωo, is
///
///     f cos θo = spectra(s) D(ωm) / (4 σ(ωi))
///
/// with the distribution of normals D and its projected area σ, or spectra(s) alone where
/// `jacobian` is 0. Points s are drawn by `luminance`. In isotropic files, φ of ωm is counted from
/// ωi.
#pragma once

#include "plugins/bsdfs/bilinear_tables.h"

#include <span>
#include <string>

namespace lucerna {

class TensorFile;

class MeasuredMaterial {
public:
    /// The value with the cosine [1/sr], and the density of ωo given ωi [1/sr].
    struct Value {
        Color f_cos{0};
        double pdf = 0;
    };

    /// Reads a file in memory; `name` begins its messages. Throws Error for what is no such file,
    /// or whose fields do not fit together, are not finite, or are negative where that means
    /// nothing. Negative colours are taken as 0: noise of a measurement, or outside of Rec.709.
    MeasuredMaterial(std::span<const std::uint8_t> bytes, const std::string& name);

    /// Local directions, both above the surface. Zero where `sample` cannot go.
    Value evaluate(Vector3 wi, Vector3 wo) const;
    /// Draws ωo given ωi, above the surface; u in [0, 1)². It may lie below.
    Vector3 sample(Vector3 wi, Vector2 u) const;

    bool isotropic() const { return parameters_.down.size() <= 2; }
    /// The directions ωi of the file, as numbers of tables.
    std::size_t direction_count() const { return parameters_.count(); }
    Vector3 direction(std::size_t table) const;
    /// The tables around a direction.
    TableMix mix(Vector3 wi) const;

private:
    struct Fold;
    void read_tables(const TensorFile& file);
    std::vector<Color> read_colors(const TensorFile& file, TableShape shape) const;

    TableParameters parameters_;  ///< φ and θ of ωi
    int symmetry_ = 1;            ///< that many parts of a turn of φ are alike
    bool jacobian_ = true;
    TableShape normals_shape_{2, 2}, area_shape_{2, 2};
    std::vector<float> normals_, area_;  ///< D and σ
    BilinearWarp visible_normals_, luminance_;
    std::vector<Color> colors_;  ///< by table and node of luminance_
};

}  // namespace lucerna
