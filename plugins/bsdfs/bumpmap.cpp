// SPDX-License-Identifier: Apache-2.0
/// bumpmap: a BSDF on a surface that a texture raises, as far as its normals are concerned.
///
/// The height h along the normal n tilts the tangents, ∂p'/∂u = ∂p/∂u + n ∂h/∂u, and the normal
/// becomes their cross product (Blinn 1978, "Simulation of Wrinkled Surfaces").
#include "plugins/bsdfs/perturbed.h"

namespace lucerna {
namespace {

class BumpMap final : public PerturbedBSDF {
public:
    explicit BumpMap(const Params& params)
        : PerturbedBSDF(params),
          height_(*params.all_nested<Texture>({1, 1}, "height of the surface").front()),
          scale_(params.real("scale", 1, any_value, "factor of the height")) {
        if (height_.attribute().empty()) return;
        params.error("texture",
                     "a bump map needs a texture that changes with uv, not an attribute of a mesh "
                     "or a volume");
    }

protected:
    Frame perturbed(const Interaction& at) const override {
        const Vector3 n = at.shading.n;
        const Vector2 slope = scale_ * height_.gradient(at.uv);
        const Vector3 dpdu = at.dpdu + n * (slope.x - glm::dot(n, at.dpdu));
        const Vector3 dpdv = at.dpdv + n * (slope.y - glm::dot(n, at.dpdv));
        const Vector3 normal = glm::cross(dpdu, dpdv);
        const float length = glm::length(normal);
        if (!(length > 0 && std::isfinite(length))) return at.shading;
        const float sign = glm::dot(normal, n) < 0 ? -1.0f : 1.0f;
        return Frame::from_normal_tangent(normal * (sign / length), dpdu);
    }

private:
    const Texture& height_;
    float scale_;
};

}  // namespace

const PluginInfo plugin = describe<BumpMap>("a BSDF on a surface raised by a texture");

}  // namespace lucerna
