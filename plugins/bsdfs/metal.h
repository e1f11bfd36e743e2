// SPDX-License-Identifier: Apache-2.0
/// What smooth and rough conductors share: index of refraction and colour.
#pragma once

#include "core/interfaces/texture.h"
#include "core/math/fresnel.h"
#include "plugins/bsdfs/conductors.h"

namespace lucerna {

/// The reflectance of a metal, from its name or from η + i k relative to the outside.
class Metal {
public:
    explicit Metal(const Params& params) {
        const std::string name = params.string(
            "material", "none", "name of a metal (\"Au\", \"Cu\", …); \"none\" reflects all");
        const std::optional<ConductorData> known = conductor(name);
        if (!known) {
            params.error("material", "there is no metal \"" + name + "\"" +
                                         did_you_mean(name, conductor_names()) +
                                         "\n  there are: " + join(conductor_names()));
        }
        const ConductorData data = known.value_or(ConductorData{Color(0), Color(1)});
        eta_ = params.color_input("eta", data.eta, non_negative,
                                  "index of refraction, real part; replaces the material's");
        k_ = params.color_input("k", data.k, non_negative,
                                "index of refraction, imaginary part; replaces the material's");
        tint_ = params.color_input("specular_reflectance", Color(1), unit_interval,
                                   "factor; 1 is physical");
    }

    Color reflectance(const Interaction& at, float cos_theta) const {
        return tint_(at) * fresnel_conductor(cos_theta, eta_(at), k_(at));
    }

private:
    ColorInput eta_, k_, tint_;
};

}  // namespace lucerna
