// SPDX-License-Identifier: Apache-2.0
/// Parameters of microfacet distributions, the same for all rough surfaces.
#pragma once

#include "core/interfaces/texture.h"
#include "core/math/microfacet.h"

namespace lucerna {

inline Microfacet::Type distribution_type(const Params& params) {
    const Microfacet::Type type =
        params.choice("distribution", Microfacet::Type::beckmann,
                      {{"beckmann", Microfacet::Type::beckmann}, {"ggx", Microfacet::Type::ggx}},
                      "distribution of the facets' normals");
    if (!params.boolean("sample_visible", true, "draw among the visible normals only")) {
        params.warning("sample_visible", "normals are always drawn among the visible ones");
    }
    return type;
}

/// A microfacet distribution whose widths may vary over the surface and with the direction.
class Roughness {
public:
    explicit Roughness(const Params& params)
        : type_(distribution_type(params)),
          alpha_u_(params.float_input("alpha", 0.1f, non_negative,
                                      "roughness: width of the distribution of slopes")),
          alpha_v_(alpha_u_) {
        const FloatInput u = params.float_input("alpha_u", alpha_u_.constant, non_negative,
                                                "roughness along the tangent, instead of alpha");
        const FloatInput v = params.float_input("alpha_v", alpha_v_.constant, non_negative,
                                                "roughness along the bitangent, instead of alpha");
        anisotropic_ = params.has("alpha_u") || params.has("alpha_v");
        if (anisotropic_ && params.has("alpha")) {
            params.error("alpha", "give either \"alpha\" or \"alpha_u\" and \"alpha_v\"");
        }
        if (params.has("alpha_u")) alpha_u_ = u;
        if (params.has("alpha_v")) alpha_v_ = v;
    }

    bool anisotropic() const { return anisotropic_; }

    Microfacet operator()(const Interaction& at) const {
        return {type_, alpha_u_(at), alpha_v_(at)};
    }

    /// `rough`, or `smooth` where the surface is so flat that it is treated as a mirror; both if a
    /// texture decides.
    Lobe lobes(Lobe rough, Lobe smooth) const {
        if (alpha_u_.texture || alpha_v_.texture) return rough | smooth;
        const Microfacet facets(type_, alpha_u_.constant, alpha_v_.constant);
        return facets.effectively_smooth() ? smooth : rough;
    }

private:
    Microfacet::Type type_;
    FloatInput alpha_u_, alpha_v_;
    bool anisotropic_ = false;
};

}  // namespace lucerna
