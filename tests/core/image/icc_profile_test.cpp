// SPDX-License-Identifier: Apache-2.0
#include "core/image/icc_profile.h"
#include "core/image/color.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace lucerna {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& bytes, std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) {
        bytes.push_back(static_cast<std::uint8_t>(value >> shift));
    }
}
void append(Bytes& bytes, std::string_view four) {
    bytes.insert(bytes.end(), four.begin(), four.end());
}

using Primaries = std::array<std::array<double, 3>, 3>;

void append_fixed(Bytes& bytes, double value) {
    append(bytes, static_cast<std::uint32_t>(std::lround(value * 65536)));
}

/// A tag of type para or curv, of a whole number of words.
Bytes parametric(std::uint32_t type, const std::vector<double>& numbers) {
    Bytes tag;
    append(tag, "para");
    append(tag, 0);
    append(tag, type << 16);
    for (const double x : numbers) append_fixed(tag, x);
    return tag;
}
Bytes table(const std::vector<double>& values) {
    Bytes tag;
    append(tag, "curv");
    append(tag, 0);
    append(tag, static_cast<std::uint32_t>(values.size()));
    for (const double x : values) {
        const auto number = static_cast<std::uint32_t>(std::lround(x));
        tag.push_back(static_cast<std::uint8_t>(number >> 8));
        tag.push_back(static_cast<std::uint8_t>(number));
    }
    while (tag.size() % 4 != 0) tag.push_back(0);
    return tag;
}
const Bytes srgb_curve = parametric(3, {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045});

/// A header, tags, and their values: the primaries in XYZ under D50, and a curve for all or for
/// each of the channels.
Bytes profile(std::string_view space, const Primaries& primaries,
              const std::vector<Bytes>& curves = {srgb_curve}) {
    Bytes bytes(16), values;
    append(bytes, space);
    bytes.resize(128);
    const bool grey = space == "GRAY";
    append(bytes, grey ? 1 : 6);
    const std::size_t start = 132 + (grey ? 1 : 6) * 12;
    const auto add = [&](std::string_view name, const Bytes& value) {
        append(bytes, name);
        append(bytes, static_cast<std::uint32_t>(start + values.size()));
        append(bytes, static_cast<std::uint32_t>(value.size()));
        values.insert(values.end(), value.begin(), value.end());
    };
    if (grey) add("kTRC", curves[0]);
    constexpr std::array<std::string_view, 6> names{"rXYZ", "gXYZ", "bXYZ", "rTRC", "gTRC", "bTRC"};
    for (std::size_t i = 0; !grey && i < 3; ++i) add(names[3 + i], curves[i % curves.size()]);
    for (std::size_t i = 0; !grey && i < 3; ++i) {
        Bytes xyz;
        append(xyz, "XYZ ");
        append(xyz, 0);
        for (const double x : primaries[i]) append_fixed(xyz, x);
        add(names[i], xyz);
    }
    bytes.insert(bytes.end(), values.begin(), values.end());
    return bytes;
}

constexpr Primaries srgb_primaries{
    {{0.43607, 0.22249, 0.01392}, {0.38515, 0.71687, 0.09708}, {0.14307, 0.06061, 0.7141}}};
constexpr Primaries adobe_primaries{
    {{0.60974, 0.31111, 0.01947}, {0.20528, 0.62567, 0.06087}, {0.14919, 0.06322, 0.74457}}};
constexpr Primaries p3_primaries{
    {{0.51512, 0.2412, -0.00105}, {0.29198, 0.69225, 0.04189}, {0.1571, 0.06657, 0.78407}}};
const Bytes srgb = profile("RGB ", srgb_primaries);

struct Followed {
    Image image;
    std::string notice;
};
Followed follow(const Bytes& bytes, Color stored = Color(0.5f)) {
    Followed result;
    result.image = Image(1, 1);
    result.image.srgb_encoded = true;
    result.image.set_rgb(0, 0, stored);
    result.notice = follow_icc_profile(bytes, result.image);
    return result;
}

TEST(IccProfile, ThatOfSrgbChangesNothing) {
    const Followed f = follow(srgb);
    EXPECT_EQ(f.notice, "");
    EXPECT_TRUE(f.image.srgb_encoded);
    EXPECT_FALSE(f.image.chromaticities);
    std::vector<double> entries;
    for (int i = 0; i < 1024; ++i) {
        entries.push_back(65535 *
                          static_cast<double>(srgb_to_linear(static_cast<float>(i) / 1023)));
    }
    EXPECT_TRUE(follow(profile("RGB ", srgb_primaries, {table(entries)})).image.srgb_encoded);
}

TEST(IccProfile, CurvesArePowersOrThatOfSrgb) {
    const auto gamma = [](const Bytes& curve) {
        const Followed f = follow(profile("RGB ", adobe_primaries, {curve}));
        EXPECT_EQ(f.notice, "");
        EXPECT_FALSE(f.image.srgb_encoded);
        return static_cast<double>(f.image.gamma);
    };
    EXPECT_EQ(gamma(table({})), 1);
    EXPECT_NEAR(gamma(table({256 * 2.19921875})), 2.19921875, 1e-5);
    EXPECT_NEAR(gamma(parametric(0, {1.8})), 1.8, 1e-4);
    EXPECT_EQ(gamma(table({0, 65535})), 1);
    // A curve that is neither: contrast in the shape of an S.
    std::vector<double> s;
    for (int i = 0; i < 256; ++i) {
        const double x = i / 255.0;
        s.push_back(65535 * x * x * (3 - 2 * x));
    }
    for (const std::vector<Bytes>& curves :
         {std::vector<Bytes>{table(s)}, {srgb_curve, srgb_curve, parametric(0, {2.2})}}) {
        const Followed f = follow(profile("RGB ", adobe_primaries, curves));
        EXPECT_NE(f.notice.find("convert it to sRGB"), std::string::npos);
        EXPECT_TRUE(f.image.srgb_encoded);
        EXPECT_FALSE(f.image.chromaticities);
    }
    EXPECT_NEAR(follow(profile("GRAY", {}, {table({256 * 2.5})})).image.gamma, 2.5, 1e-3);
}

TEST(IccProfile, PrimariesAreThoseOfTheProfile) {
    // Red of Display P3 in linear Rec. 709 (Rec. 709 and P3 have the same white).
    Followed p3 = follow(profile("RGB ", p3_primaries), {1, 0, 0});
    ColorConfig().to_rendering(p3.image);
    EXPECT_LT(glm::distance(p3.image.rgb(0, 0), Color(1.22494f, -0.04206f, -0.01964f)), 2e-3f);
    Followed adobe =
        follow(profile("RGB ", adobe_primaries, {table({256 * 2.19921875})}), {0, 1, 0});
    ColorConfig().to_rendering(adobe.image);
    EXPECT_LT(glm::distance(adobe.image.rgb(0, 0), Color(-0.39836f, 1, -0.04293f)), 2e-3f);
    Followed white = follow(profile("RGB ", p3_primaries), Color(1));
    ColorConfig().to_rendering(white.image);
    EXPECT_LT(glm::distance(white.image.rgb(0, 0), Color(1)), 2e-3f);
}

TEST(IccProfile, ShortenedOnesAreTold) {
    for (std::size_t size = 0; size < srgb.size(); ++size) {
        const Bytes shortened(srgb.begin(), srgb.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_NE(follow(shortened).notice, "") << size;
    }
    Bytes endless = srgb;
    endless[128] = endless[129] = 0xff;  // billions of tags
    EXPECT_EQ(follow(endless).notice, "");
    Bytes table_without_end = profile("RGB ", srgb_primaries, {table({0, 9, 65535})});
    for (std::size_t i = 0; i + 4 < table_without_end.size(); ++i) {
        if (std::string_view(reinterpret_cast<const char*>(&table_without_end[i]), 4) != "curv") {
            continue;
        }
        table_without_end[i + 8] = 0xff;
    }
    EXPECT_NE(follow(table_without_end).notice, "");
}

}  // namespace
}  // namespace lucerna
