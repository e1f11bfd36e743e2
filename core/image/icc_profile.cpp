// SPDX-License-Identifier: Apache-2.0
#include "core/image/icc_profile.h"

#include "core/image/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace lucerna {

namespace {

using Profile = std::span<const std::uint8_t>;
using Xyz = std::array<double, 3>;

/// Big-endian; 0 beyond the end.
std::uint32_t number_at(Profile profile, std::size_t offset) {
    if (offset > profile.size() || profile.size() - offset < 4) return 0;
    return std::uint32_t{profile[offset]} << 24 | std::uint32_t{profile[offset + 1]} << 16 |
           std::uint32_t{profile[offset + 2]} << 8 | profile[offset + 3];
}

constexpr std::uint32_t signature(std::string_view four) {
    std::uint32_t value = 0;
    for (const char c : four) value = value << 8 | static_cast<std::uint8_t>(c);
    return value;
}

/// The value of the tag with this name; empty if there is none.
Profile tag_of(Profile profile, std::string_view name) {
    constexpr std::size_t header = 128, entry = 12;
    const std::uint32_t count = number_at(profile, header);
    for (std::size_t i = 0; i < count && header + 4 + i * entry < profile.size(); ++i) {
        const std::size_t at = header + 4 + i * entry;
        if (number_at(profile, at) != signature(name)) continue;
        const std::size_t value = number_at(profile, at + 4);
        return value < profile.size() ? profile.subspan(value) : Profile();
    }
    return {};
}

/// 16 bits before and 16 behind the point.
double fixed_at(Profile tag, std::size_t offset) {
    return static_cast<std::int32_t>(number_at(tag, offset)) / 65536.0;
}

/// Three numbers of a tag of type XYZ.
std::optional<Xyz> colorant(Profile profile, std::string_view name) {
    const Profile tag = tag_of(profile, name);
    if (number_at(tag, 0) != signature("XYZ ") || tag.size() < 20) return {};
    return Xyz{fixed_at(tag, 8), fixed_at(tag, 12), fixed_at(tag, 16)};
}

/// Linear light of a stored value x in [0, 1], by a tag of type curv or para (10.6, 10.18). Empty
/// if it is neither, or cut off.
std::optional<double> curve_at(Profile tag, double x) {
    if (number_at(tag, 0) == signature("curv") && tag.size() >= 12) {
        const std::size_t count = number_at(tag, 8);
        if (count > (tag.size() - 12) / 2) return {};
        const auto entry = [&](std::size_t i) {
            return double{256.0} * tag[12 + 2 * i] + tag[13 + 2 * i];
        };
        if (count == 0) return x;
        if (count == 1) return std::pow(x, entry(0) / 256);
        const double place = x * static_cast<double>(count - 1);
        const auto below = std::min(static_cast<std::size_t>(place), count - 2);
        return std::lerp(entry(below), entry(below + 1), place - static_cast<double>(below)) /
               65535;
    }
    if (number_at(tag, 0) != signature("para") || tag.size() < 16) return {};
    const std::uint32_t type = number_at(tag, 8) >> 16;
    constexpr std::array<std::size_t, 5> counts = {1, 3, 4, 5, 7};
    if (type >= counts.size() || tag.size() < 12 + 4 * counts[type]) return {};
    std::array<double, 7> p{1, 1, 0, 0, 0, 0, 0};  // g a b c d e f
    for (std::size_t i = 0; i < counts[type]; ++i) p[i] = fixed_at(tag, 12 + 4 * i);
    const auto& [g, a, b, c, d, e, f] = p;
    const auto power = [x, g = g, a = a, b = b] { return std::pow(std::max(a * x + b, 0.0), g); };
    if (type < 3) {
        const double offset = type == 2 ? c : 0;
        return type == 0 || a * x + b >= 0 ? power() + offset : offset;
    }
    return x >= d ? power() + e : c * x + f;
}

/// Sets the curve of the picture, if it is one that a picture can have.
bool follow_curve(Profile tag, Image& image) {
    const std::optional<double> middle = curve_at(tag, 0.5);
    if (!middle || !(*middle > 0 && *middle < 1)) return false;
    const double gamma = std::log(*middle) / std::log(0.5);
    double from_srgb = 0, from_power = 0;
    for (int i = 0; i <= 64; ++i) {
        const double x = i / 64.0;
        const double y = curve_at(tag, x).value_or(-1);
        from_srgb = std::max(
            from_srgb, std::abs(y - static_cast<double>(srgb_to_linear(static_cast<float>(x)))));
        from_power = std::max(from_power, std::abs(y - std::pow(x, gamma)));
    }
    constexpr double tolerance = 3e-3;  // less than a step of 8 bits, where they are close
    if (std::min(from_srgb, from_power) > tolerance) return false;
    image.srgb_encoded = from_srgb <= tolerance;
    image.gamma = image.srgb_encoded ? 1 : static_cast<float>(gamma);
    return true;
}

/// The tags are the same, as is usual, or of the same values.
bool same_curve(Profile a, Profile b) {
    for (int i = 0; i <= 64; ++i) {
        const std::optional<double> x = curve_at(a, i / 64.0), y = curve_at(b, i / 64.0);
        if (!x || !y || std::abs(*x - *y) > 1e-3) return false;
    }
    return true;
}

Vector2d chromaticity(const Xyz& c) { return Vector2d(c[0], c[1]) / (c[0] + c[1] + c[2]); }

bool is_near(const std::optional<Xyz>& a, const Xyz& b) {
    if (!a) return false;
    constexpr double tolerance = 2e-3;  // more than profiles of sRGB differ among each other
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs((*a)[k] - b[k]) > tolerance) return false;
    }
    return true;
}

}  // namespace

std::string follow_icc_profile(Profile profile, Image& image) {
    if (number_at(profile, 16) == signature("GRAY")) {
        follow_curve(tag_of(profile, "kTRC"), image);
        return "";
    }
    const std::string refusal =
        "it has an ICC profile that is not applied, since it is not one of primaries and a curve; "
        "convert it to sRGB";
    const auto red = colorant(profile, "rXYZ"), green = colorant(profile, "gXYZ"),
               blue = colorant(profile, "bXYZ");
    if (!red || !green || !blue || number_at(profile, 16) != signature("RGB ")) return refusal;
    const Profile curve = tag_of(profile, "rTRC");
    if (!same_curve(curve, tag_of(profile, "gTRC")) ||
        !same_curve(curve, tag_of(profile, "bTRC")) || !follow_curve(curve, image)) {
        return refusal;
    }
    // The primaries of IEC 61966-2-1, adapted to D50, as all are.
    const bool srgb = is_near(red, {0.4361, 0.2225, 0.0139}) &&
                      is_near(green, {0.3851, 0.7169, 0.0971}) &&
                      is_near(blue, {0.1431, 0.0606, 0.7141});
    if (srgb) return "";
    for (const Xyz& c : {*red, *green, *blue}) {
        if (!(c[0] + c[1] + c[2] > 0)) return refusal;
    }
    image.chromaticities = Chromaticities{.red = chromaticity(*red),
                                          .green = chromaticity(*green),
                                          .blue = chromaticity(*blue),
                                          .white = chromaticity({0.9642, 1, 0.8249})};
    return "";
}

}  // namespace lucerna
