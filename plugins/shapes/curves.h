// SPDX-License-Identifier: Apache-2.0
/// Round curves with a radius that changes along them: what `linearcurve` and `bsplinecurve` share.
///
/// A file is text: a control point on each line, `x y z radius`, and an empty line between two
/// curves. As in Mitsuba, `to_world` moves control points and leaves radii as they are: curves stay
/// round whatever it does; only an `instance` scales radii, too. u is the angle around a curve, v
/// runs from its end to its beginning, over all segments of the file (mesh.h tells why); the local
/// y axis of a hit runs along the curve, towards the last control point. Only the outside is met:
/// rays leave a curve from inside without a hit.
#pragma once

#include "core/interfaces/shape.h"

namespace lucerna {

class CurveShape : public Shape {
public:
    Geometry geometry() const final;
    Bounds3 bounds() const final { return bounds_; }
    void fill(const Ray& ray, const Hit& hit, Interaction& at) const final;

    std::uint32_t primitive_count() const final {
        return static_cast<std::uint32_t>(first_.size());
    }
    // Curves do not emit.
    float area(std::uint32_t) const final { return 0; }
    SurfaceSample sample_area(std::uint32_t, Vector2) const final { return {}; }

protected:
    CurveShape(const Params& params, CurveGeometry::Basis basis);

private:
    struct Place;
    Place place(const Hit& hit) const;
    void take_file(const std::filesystem::path& path);

    CurveGeometry::Basis basis_;
    std::vector<glm::vec4> points_;
    std::vector<std::uint32_t> first_;
    std::vector<std::uint8_t> neighbours_;
    Bounds3 bounds_;
};

}  // namespace lucerna
