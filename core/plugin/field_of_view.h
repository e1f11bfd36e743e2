// SPDX-License-Identifier: Apache-2.0
/// The field of view of cameras and projectors as parameters.
#pragma once

#include "core/plugin/params.h"

#include <charconv>
#include <numbers>

namespace lucerna {

/// Half the width of the image at the depth 1, of an image of width / height = `aspect`: the
/// parameters fov and fov_axis, or focal_length.
inline double half_width_at_unit_depth(const Params& params, double aspect) {
    enum class Axis { x, y, diagonal, smaller, larger };
    const double fov = static_cast<double>(
        params.real("fov", 46.7930, {.min = 0, .max = 180, .open_min = true, .open_max = true},
                    "angle of view along fov_axis [degrees]; if not given, focal_length counts"));
    Axis axis = params.choice<Axis>("fov_axis", Axis::x,
                                    {{"x", Axis::x},
                                     {"y", Axis::y},
                                     {"diagonal", Axis::diagonal},
                                     {"smaller", Axis::smaller},
                                     {"larger", Axis::larger}},
                                    "where fov is measured");
    std::string length = params.string(
        "focal_length", "50mm", "of a lens before 35 mm film, whose diagonal is the image's [mm]");

    double half = std::tan(fov * std::numbers::pi / 360);
    if (params.has("fov")) {
        if (params.has("focal_length")) {
            params.error("focal_length", "give either fov or focal_length, not both");
        }
    } else {
        if (length.ends_with("mm")) length.resize(length.size() - 2);
        double mm = 0;
        const char* const end = length.data() + length.size();
        const auto [stop, status] = std::from_chars(length.data(), end, mm);
        if (status != std::errc() || stop != end || !(mm > 0) || !std::isfinite(mm)) {
            params.error("focal_length",
                         "focal_length must be a positive number of millimetres "
                         "like \"50mm\"");
            mm = 50;
        }
        half = std::hypot(36.0, 24.0) / (2 * mm);
        axis = Axis::diagonal;
    }
    if (axis == Axis::smaller) axis = aspect > 1 ? Axis::y : Axis::x;
    if (axis == Axis::larger) axis = aspect > 1 ? Axis::x : Axis::y;
    if (axis == Axis::y) return half * aspect;
    if (axis == Axis::diagonal) return half / std::hypot(1.0, 1 / aspect);
    return half;
}

}  // namespace lucerna
