// SPDX-License-Identifier: Apache-2.0
/// sggx: light is reflected by flakes that are oriented, as the fibres of cloth (Heitz, Dupuy,
/// Crassin and Dachsbacher 2015, "The SGGX Microflake Distribution").
///
/// The density D of the flakes' normals is that of an ellipsoid, and σ is their projected area, by
/// which the extinction of the medium is multiplied. h is half-way between wo and wi.
///
///     σ(w) = √(wᵀ S w)      D(m) = 1 / (π √|S| (mᵀ S⁻¹ m)²)      f(wo, wi) = D(h) / (4 σ(wo))
///
/// With S = L Lᵀ, normals that wo sees are L n, where n is a normal of the unit sphere that Lᵀ wo
/// sees: the ellipsoid is an image of the sphere.
#include "core/description/values.h"
#include "core/interfaces/phase.h"
#include "core/interfaces/volume.h"
#include "core/math/frame.h"
#include "core/math/warp.h"

#include <fmt/format.h>

#include <array>
#include <vector>

namespace lucerna {
namespace {

/// A positive definite matrix S = L Lᵀ, where L is a lower triangle.
class Ellipsoid {
public:
    explicit Ellipsoid(const SymmetricMatrix& s) {
        const auto root = [](double x) { return std::sqrt(std::max(x, least)); };
        xx_ = root(static_cast<double>(s.xx));
        yx_ = static_cast<double>(s.xy) / xx_;
        zx_ = static_cast<double>(s.xz) / xx_;
        yy_ = root(static_cast<double>(s.yy) - yx_ * yx_);
        zy_ = (static_cast<double>(s.yz) - yx_ * zx_) / yy_;
        zz_ = root(static_cast<double>(s.zz) - zx_ * zx_ - zy_ * zy_);
    }

    /// L v
    Vector3d image(Vector3d v) const {
        return {xx_ * v.x, yx_ * v.x + yy_ * v.y, zx_ * v.x + zy_ * v.y + zz_ * v.z};
    }
    /// Lᵀ v, whose length is the projected area along v.
    Vector3d transposed_image(Vector3d v) const {
        return {xx_ * v.x + yx_ * v.y + zx_ * v.z, yy_ * v.y + zy_ * v.z, zz_ * v.z};
    }
    /// The density D of a unit normal [1/sr].
    double density(Vector3d m) const {
        const double x = m.x / xx_, y = (m.y - yx_ * x) / yy_;
        const double z = (m.z - zx_ * x - zy_ * y) / zz_;
        const double square = x * x + y * y + z * z;
        return 1 / (std::numbers::pi * xx_ * yy_ * zz_ * square * square);
    }

private:
    static constexpr double least = 1e-60;  ///< where S is zero

    double xx_, yx_, zx_, yy_, zy_, zz_;
};

class Sggx final : public Phase {
public:
    explicit Sggx(const Params& params)
        : constant_(read_matrix(params)),
          constant_ellipsoid_(constant_),
          volume_(params.child<Volume>("S", "")) {
        if (volume_ && !volume_->has_matrices()) {
            params.error("S", "the volume must have six channels: xx, yy, zz, xy, xz, yz");
            volume_ = nullptr;
        }
    }

    PhaseValue evaluate(Vector3 p, Vector3 wo, Vector3 wi) const override {
        return value(ellipsoid(p), Vector3d(wo), half_way(wo, wi));
    }

    PhaseSample sample(Vector3 p, Vector3 wo, float, Vector2 u) const override {
        const Ellipsoid flakes = ellipsoid(p);
        const Vector3d w(wo);
        const Vector3 seen(glm::normalize(flakes.transposed_image(w)));
        const Vector3 n = Frame::from_normal(seen).to_world(square_to_cosine_hemisphere(u));
        const Vector3d m = glm::normalize(flakes.image(Vector3d(n)));
        const Vector3 wi(glm::normalize(2 * glm::dot(w, m) * m - w));
        return {.wi = wi, .weight = 1, .pdf = value(flakes, w, m).pdf};
    }

    bool oriented() const override { return true; }
    bool uniform() const override { return !volume_ || volume_->resolution() == glm::ivec3(1); }
    float projected_area(Vector3 p, Vector3 w) const override {
        return static_cast<float>(std::sqrt(std::max(quadratic_form(matrix(p), w), 0.0)));
    }
    float max_projected_area(const Bounds3& box) const override {
        const double largest = volume_ ? static_cast<double>(volume_->max(known(box)))
                                       : eigenvalues(constant_).largest;
        // Interpolation rounds, and directions are not quite of length 1.
        return static_cast<float>(std::sqrt(largest) * (1 + 0x1p-19));
    }

private:
    static SymmetricMatrix read_matrix(const Params& params) {
        const SymmetricMatrix sphere{.xx = 1, .yy = 1, .zz = 1};
        // A nested volume leaves the default.
        const std::string text =
            params.string("S", "1, 1, 1, 0, 0, 0",
                          "the matrix, as xx, yy, zz, xy, xz, yz, or a volume of six channels");
        std::vector<double> numbers;
        try {
            numbers = parse_numbers(text);
        } catch (const Error& e) {
            params.error("S", e.what());
            return sphere;
        }
        if (numbers.size() != 6) {
            params.error("S", fmt::format("\"S\" must be six numbers, xx, yy, zz, xy, xz, yz, not "
                                          "{}",
                                          numbers.size()));
            return sphere;
        }
        std::array<float, 6> s;
        for (std::size_t i = 0; i < s.size(); ++i) s[i] = static_cast<float>(numbers[i]);
        const SymmetricMatrix matrix{s[0], s[1], s[2], s[3], s[4], s[5]};
        const EigenvalueRange range = eigenvalues(matrix);
        if (!is_zero_or_positive_definite(range) || !(s[0] > 0)) {
            params.error("S", fmt::format("\"S\" must be positive definite; its eigenvalues are "
                                          "from {:.3g} to {:.3g}",
                                          range.least, range.largest));
            return sphere;
        }
        return matrix;
    }

    /// The box, or all of the volume if the box reaches beyond: there, its voxels are repeated.
    Bounds3 known(const Bounds3& box) const {
        const Bounds3 all = volume_->bounds();
        const bool inside = glm::all(glm::greaterThanEqual(box.min, all.min)) &&
                            glm::all(glm::lessThanEqual(box.max, all.max));
        return inside ? box : all;
    }

    SymmetricMatrix matrix(Vector3 p) const { return volume_ ? volume_->matrix(p) : constant_; }
    Ellipsoid ellipsoid(Vector3 p) const {
        return volume_ ? Ellipsoid(volume_->matrix(p)) : constant_ellipsoid_;
    }

    /// Any normal of wo, if light goes on as it came.
    static Vector3d half_way(Vector3 wo, Vector3 wi) {
        const Vector3d sum = Vector3d(wo) + Vector3d(wi);
        const double length = glm::length(sum);
        return length > 0 ? sum / length : Vector3d(Frame::from_normal(wo).s);
    }

    static PhaseValue value(const Ellipsoid& ellipsoid, Vector3d wo, Vector3d h) {
        const double area = glm::length(ellipsoid.transposed_image(wo));
        const auto f = static_cast<float>(ellipsoid.density(h) / (4 * area));
        return {.f = f, .pdf = f};
    }

    SymmetricMatrix constant_;
    Ellipsoid constant_ellipsoid_;
    const Volume* volume_;
};

}  // namespace

const PluginInfo plugin =
    describe<Sggx>("flakes or fibres that are oriented; extinction depends on the direction");

}  // namespace lucerna
