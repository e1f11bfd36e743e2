// SPDX-License-Identifier: Apache-2.0
/// normalmap: a BSDF around the normals that a texture stores.
///
/// Red, green and blue in [0, 1] are x, y and z in [−1, 1] along the tangent, the bitangent and
/// the normal; an image must be read raw (`<boolean name="raw" value="true"/>`). A colour is the
/// same normal everywhere: (0.5, 0.5, 1) changes nothing.
#include "plugins/bsdfs/perturbed.h"

namespace lucerna {
namespace {

class NormalMap final : public PerturbedBSDF {
public:
    explicit NormalMap(const Params& params) : PerturbedBSDF(params), normals_(normals(params)) {}

protected:
    Frame perturbed(const Interaction& at) const override {
        const Vector3 normal = 2.0f * normals_(at) - Vector3(1);
        if (!(normal.z > 0 && is_finite(normal))) return at.shading;
        const Frame base = Frame::from_normal_tangent(at.shading.n, at.dpdu);
        return Frame::from_normal_tangent(glm::normalize(base.to_world(normal)), at.dpdu);
    }

private:
    /// A colour by its name; a texture by whatever name, as in older scenes.
    static ColorInput normals(const Params& params) {
        constexpr const char* name = "normalmap";
        if (params.has(name)) return params.color_input(name, Color(1), unit_interval, "normals");
        return {.texture =
                    params.all_nested<Texture>({1, 1}, "normalmap: the normals, raw").front()};
    }

    ColorInput normals_;
};

}  // namespace

const PluginInfo plugin = describe<NormalMap>("a BSDF around the normals of a texture");

}  // namespace lucerna
