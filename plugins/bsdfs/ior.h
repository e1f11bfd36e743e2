// SPDX-License-Identifier: Apache-2.0
/// Indices of refraction as parameters: a number, or the name of a substance.
#pragma once

#include "core/plugin/params.h"
#include "plugins/bsdfs/conductors.h"

namespace lucerna {

/// Wider than any substance; beyond it squares and quotients leave the range of floats.
inline constexpr Range ior_range{.min = 0.01, .max = 1000};

/// `<float name="int_ior" value="1.5"/>` or `<string name="int_ior" value="bk7"/>`.
inline float index_of_refraction(const Params& params, std::string_view name,
                                 std::string_view default_name, std::string_view doc) {
    const double default_value = dielectric_ior(default_name).value_or(1);
    if (!params.is_word(name)) return params.real(name, default_value, ior_range, doc);
    const std::string word = params.string(name, default_name, doc);
    const std::optional<double> value = dielectric_ior(word);
    if (!value) {
        params.error(name, "the index of refraction of \"" + word + "\" is not known" +
                               did_you_mean(word, dielectric_names()) +
                               "\n  known are: " + join(dielectric_names()));
    }
    return static_cast<float>(value.value_or(default_value));
}

/// Index on the inside over that on the outside, from `int_ior` and `ext_ior`.
inline float relative_ior(const Params& params, std::string_view default_inside) {
    const float inside = index_of_refraction(
        params, "int_ior", default_inside,
        "index of refraction inside: a number, or a name (\"bk7\", \"water\", …)");
    const float outside = index_of_refraction(params, "ext_ior", "air",
                                              "index of refraction outside: a number, or a name");
    return inside / outside;
}

}  // namespace lucerna
