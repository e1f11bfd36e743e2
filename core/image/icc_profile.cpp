// SPDX-License-Identifier: Apache-2.0
#include "core/image/icc_profile.h"

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

/// The tag of type XYZ with this name: three numbers of 16 bits before and 16 behind the point.
std::optional<Xyz> colorant(Profile profile, std::string_view name) {
    constexpr std::size_t header = 128, entry = 12;
    const std::uint32_t count = number_at(profile, header);
    for (std::size_t i = 0; i < count && header + 4 + i * entry < profile.size(); ++i) {
        const std::size_t at = header + 4 + i * entry;
        if (number_at(profile, at) != signature(name)) continue;
        const std::size_t value = number_at(profile, at + 4);
        if (number_at(profile, value) != signature("XYZ ")) return {};
        Xyz xyz;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto fixed = static_cast<std::int32_t>(number_at(profile, value + 8 + 4 * k));
            xyz[k] = fixed / 65536.0;
        }
        return xyz;
    }
    return {};
}

bool is_near(const std::optional<Xyz>& a, const Xyz& b) {
    if (!a) return false;
    constexpr double tolerance = 2e-3;  // more than profiles of sRGB differ among each other
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs((*a)[k] - b[k]) > tolerance) return false;
    }
    return true;
}

}  // namespace

std::string icc_notice(Profile profile) {
    if (number_at(profile, 16) == signature("GRAY")) return "";
    // The primaries of IEC 61966-2-1, adapted to D50.
    const bool srgb = is_near(colorant(profile, "rXYZ"), {0.4361, 0.2225, 0.0139}) &&
                      is_near(colorant(profile, "gXYZ"), {0.3851, 0.7169, 0.0971}) &&
                      is_near(colorant(profile, "bXYZ"), {0.1431, 0.0606, 0.7141});
    if (srgb) return "";
    return "it has an ICC profile with other primaries than sRGB, which is not applied; convert it "
           "to sRGB";
}

}  // namespace lucerna
