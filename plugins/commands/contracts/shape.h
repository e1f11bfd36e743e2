// SPDX-License-Identifier: Apache-2.0
/// What every shape that has a surface promises (core/interfaces/shape.h).
#pragma once

#include "core/scene/scene.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna::contracts {

/// A shape alone in a scene. Nothing about it is known but what it says.
struct ShapeTrial {
    const Scene& scene;
    const Shape& shape;

    explicit ShapeTrial(const Scene& alone) : scene(alone), shape(*alone.shapes().back()) {}

    /// Size of the shape, and of its coordinates.
    float extent() const { return max_component(shape.bounds().extent()); }
    float magnitude() const;
    /// The first surface from `p` along `d`, which need not be a unit vector.
    std::optional<Interaction> meet(Vector3 p, Vector3 d) const;
    /// A point of the surface, of a primitive chosen at random.
    SurfaceSample sample(Rng& rng) const;
    /// Points from which it is seen: far, near, and inside of it.
    std::vector<Vector3> viewpoints() const;
};

/// Points sampled by area lie on the surface, with its normal, in their bounds and cones.
Evidence shape_samples(const ShapeTrial& trial, const Effort& effort);
/// Areas are those that random lines measure: through a sphere of radius R, they cross a surface
/// of area A on average A / (2πR²) times (Santaló 1976, "Integral Geometry and Geometric
/// Probability", 14.3).
Evidence shape_areas(const ShapeTrial& trial, const Effort& effort);
/// The density per solid angle covers what is visible, and is that of the samples.
Evidence shape_solid_angles(const ShapeTrial& trial, const Effort& effort);
/// The nearest hit is found: as by looking at every triangle, and on the way back.
Evidence shape_hits(const ShapeTrial& trial, const Effort& effort);
/// Points are on the surface within their error, and rays leave it on either side.
Evidence shape_errors(const ShapeTrial& trial, const Effort& effort);
/// `dpdu` and `dpdv` follow the parameters.
Evidence shape_derivatives(const ShapeTrial& trial, const Effort& effort);
Evidence shape_lanes(const ShapeTrial& trial, const Effort& effort);

/// All of them.
std::vector<Evidence> check(const ShapeTrial& trial, const Effort& effort);

}  // namespace lucerna::contracts
