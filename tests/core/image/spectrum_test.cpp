// SPDX-License-Identifier: Apache-2.0
#include "core/image/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/image/cie_tables.h"
#include "tests/core/image/damage.h"
#include "tests/paths.h"

namespace lucerna {
namespace {

/// CIE xy of a linear Rec.709 colour (ITU-R BT.709, rounded).
Vector2d xy_of(Color c) {
    const double r = double{c.x}, g = double{c.y}, b = double{c.z};
    const double x = 0.4123908 * r + 0.3575843 * g + 0.1804808 * b;
    const double y = 0.2126390 * r + 0.7151687 * g + 0.0721923 * b;
    const double z = 0.0193308 * r + 0.1191948 * g + 0.9505322 * b;
    return {x / (x + y + z), y / (x + y + z)};
}

TEST(CieTables, HaveTheKnownTotals) {
    double x = 0, y = 0, z = 0, x_d65 = 0, y_d65 = 0, z_d65 = 0;
    for (const CieSample& s : cie_table) {
        x += s.x * cie_step;
        y += s.y * cie_step;
        z += s.z * cie_step;
        x_d65 += s.x * s.d65;
        y_d65 += s.y * s.d65;
        z_d65 += s.z * s.d65;
    }
    // The CIE's sums at 1 nm: 106.8655, 106.8569, 106.8922.
    EXPECT_NEAR(x, 106.8655, 0.01);
    EXPECT_NEAR(y, 106.8569, 0.001);
    EXPECT_NEAR(z, 106.8922, 0.01);
    // The white point of D65 at 1 nm, CIE 15: x = 0.31272, y = 0.32903.
    EXPECT_NEAR(x_d65 / (x_d65 + y_d65 + z_d65), 0.31272, 5e-5);
    EXPECT_NEAR(y_d65 / (x_d65 + y_d65 + z_d65), 0.32903, 5e-5);
}

TEST(Spectrum, ConstantReflectanceIsExactlyGrey) {
    for (const double value : {0.0, 0.18, 0.5, 1.0}) {
        const Color expected(static_cast<float>(value));
        EXPECT_EQ(rgb_from_spectrum({{}, {value}}, SpectrumUse::reflectance), expected);
        const Spectrum listed{{300, 555.5, 900}, {value, value, value}};
        const Color rgb = rgb_from_spectrum(listed, SpectrumUse::reflectance);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], expected[c], 1e-6f);
    }
}

TEST(Spectrum, ReflectancesAreSeenUnderD65) {
    // Expected: sums over the table at 5 nm, computed apart from this code. Without D65 in the
    // integral, red would be 0.586 and blue 0.165.
    const Color ramp = rgb_from_spectrum({{360, 830}, {0, 1}}, SpectrumUse::reflectance);
    EXPECT_NEAR(ramp.x, 0.600947f, 1e-4);
    EXPECT_NEAR(ramp.y, 0.389380f, 1e-4);
    EXPECT_NEAR(ramp.z, 0.171976f, 1e-4);
}

TEST(Spectrum, ConstantEmissionIsTheEqualEnergyWhite) {
    const Color rgb = rgb_from_spectrum({{}, {2}}, SpectrumUse::emission);
    // 2 · (inverse of the Rec.709 primaries) · (1, 1, 1)
    EXPECT_NEAR(rgb.x, 2 * 1.20499f, 1e-3);
    EXPECT_NEAR(rgb.y, 2 * 0.94828f, 1e-3);
    EXPECT_NEAR(rgb.z, 2 * 0.90862f, 1e-3);
    EXPECT_NEAR(luminance(rgb), 2, 1e-5);
}

TEST(Spectrum, EmissionOfD65IsWhite) {
    Spectrum d65;
    for (std::size_t i = 0; i < cie_table.size(); ++i) {
        d65.wavelengths.push_back(cie_first + cie_step * static_cast<double>(i));
        d65.values.push_back(cie_table[i].d65);
    }
    const Color rgb = rgb_from_spectrum(d65, SpectrumUse::emission);
    EXPECT_NEAR(rgb.x / rgb.y, 1, 5e-4);
    EXPECT_NEAR(rgb.z / rgb.y, 1, 5e-4);
    EXPECT_NEAR(luminance(rgb), 98.99, 0.2);  // the constant in Mitsuba
}

TEST(Spectrum, IsLinearInItsValuesAndZeroOutside) {
    const Spectrum band{{500, 510, 590, 600}, {0, 1, 1, 0}};
    EXPECT_EQ(band.at(499), 0);
    EXPECT_EQ(band.at(505), 0.5);
    EXPECT_EQ(band.at(600), 0);
    EXPECT_EQ(band.at(590), 1);
    Spectrum doubled = band;
    for (double& v : doubled.values) v *= 2;
    const Color a = rgb_from_spectrum(band, SpectrumUse::emission);
    const Color b = rgb_from_spectrum(doubled, SpectrumUse::emission);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(b[c], 2 * a[c], 1e-5);
    EXPECT_GT(a.y, a.x);
    EXPECT_EQ(a.z, 0);  // outside the gamut
    EXPECT_EQ(rgb_from_spectrum({{100, 200}, {1, 1}}, SpectrumUse::emission), Color(0));
}

TEST(Spectrum, ALineAddsItsLuminance) {
    // On a white floor, so that nothing is clamped. Area 5 nm, CIE ȳ(555) = 1, sides 0.995.
    const Spectrum line{{360, 550, 555, 560, 830}, {1, 1, 2, 1, 1}};
    const Color rgb = rgb_from_spectrum(line, SpectrumUse::emission);
    EXPECT_NEAR(luminance(rgb) - 1, 5 * 0.998 / 106.857, 5e-5);
}

TEST(Spectrum, GoldHasTheIndexThatMitsubaComputes) {
    // Index of refraction of gold (Palik), 399 to 856 nm; expected: Mitsuba's RGB value.
    const Spectrum gold{
        {354.240509, 359.374420, 364.659332, 370.102020, 375.709625, 381.489777, 387.450562,
         393.600555, 399.948975, 406.505493, 413.280579, 420.285339, 427.531647, 435.032196,
         442.800629, 450.851562, 459.200653, 467.864838, 476.862213, 486.212463, 495.936707,
         506.057861, 516.600769, 527.592224, 539.061646, 551.040771, 563.564453, 576.670593,
         590.400818, 604.800842, 619.920898, 635.816284, 652.548279, 670.184753, 688.800964,
         708.481018, 729.318665, 751.419250, 774.901123, 799.897949, 826.561157, 855.063293},
        {1.740000, 1.727625, 1.716000, 1.705875, 1.696000, 1.684750, 1.674000, 1.666000, 1.658000,
         1.647250, 1.636000, 1.628000, 1.616000, 1.596250, 1.562000, 1.502125, 1.426000, 1.345875,
         1.242000, 1.086750, 0.916000, 0.754500, 0.608000, 0.491750, 0.402000, 0.345500, 0.306000,
         0.267625, 0.236000, 0.212375, 0.194000, 0.177750, 0.166000, 0.161000, 0.160000, 0.160875,
         0.164000, 0.169500, 0.176000, 0.181375, 0.188000, 0.198125}};
    const Color eta = rgb_from_spectrum(gold, SpectrumUse::emission);
    EXPECT_NEAR(eta.x, 0.143119f, 2e-3);
    EXPECT_NEAR(eta.y, 0.374957f, 2e-3);
    EXPECT_NEAR(eta.z, 1.442479f, 2e-3);
}

TEST(Blackbody, HasTheChromaticitiesOfTheStandards) {
    // Illuminant A is Planckian at 2855.5 K: CIE 15, x = 0.44758, y = 0.40745.
    const Vector2d a = xy_of(blackbody(2855.5));
    EXPECT_NEAR(a.x, 0.44758, 1e-4);
    EXPECT_NEAR(a.y, 0.40745, 1e-4);
    const Vector2d p6500 = xy_of(blackbody(6500));
    EXPECT_NEAR(p6500.x, 0.31352, 1e-4);
    EXPECT_NEAR(p6500.y, 0.32363, 1e-4);
}

TEST(Blackbody, HasTheLuminanceThatDefinedTheCandela) {
    // Freezing platinum, 2041.4 K: 60 cd/cm² (the unit from 1948 to 1979).
    const double candela_per_m2 = 683 * 106.857 * double{luminance(blackbody(2041.4))};
    EXPECT_NEAR(candela_per_m2 / 6e5, 1, 0.01);
}

TEST(Blackbody, RefusesImpossibleTemperatures) {
    for (const double kelvin : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
        EXPECT_THROW(blackbody(kelvin), Error) << kelvin;
    }
    EXPECT_EQ(blackbody(1), Color(0));  // underflows, and stays defined
    EXPECT_TRUE(is_finite(blackbody(1e9)));
}

TEST(SpectrumFile, IsRead) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.spd") << "# gold\n\n 400\t1.5 # first\r\n\t500   2e-1\n600.5 0";
    const Spectrum spectrum = read_spectrum(folder / "a.spd");
    EXPECT_EQ(spectrum.wavelengths, (std::vector<double>{400, 500, 600.5}));
    EXPECT_EQ(spectrum.values, (std::vector<double>{1.5, 0.2, 0}));
}

TEST(SpectrumFile, ErrorsNameTheLine) {
    const auto message = [](std::string_view text) {
        return file_error([&] { parse_spectrum(text, "a.spd"); });
    };
    // Not what it holds.
    EXPECT_EQ(message("400 1\n500 x\n"),
              "a.spd:2: this is not a wavelength and a value: two finite numbers with a space "
              "between them are expected");
    EXPECT_TRUE(message("400 1\n500\n").starts_with("a.spd:2: "));
    EXPECT_TRUE(message("#\n400 1 2\n").starts_with("a.spd:2: "));
    EXPECT_TRUE(message("400 1\n500 1,5\n").starts_with("a.spd:2: "));
    EXPECT_TRUE(message("400 nan\n500 1\n").starts_with("a.spd:1: "));
    EXPECT_TRUE(message("400 1\n\n400 1\n").starts_with("a.spd:3: wavelengths must rise"));
    EXPECT_NE(message("400 1\n").find("at least two"), std::string::npos);
    EXPECT_NE(message("").find("at least two"), std::string::npos);
}

TEST(Spectrum, RefusesListsThatDoNotFit) {
    const auto convert = [](const Spectrum& s) { rgb_from_spectrum(s, SpectrumUse::emission); };
    EXPECT_THROW(convert({}), Error);
    EXPECT_THROW(convert({{400, 500}, {1}}), Error);
    EXPECT_THROW(convert({{400}, {1}}), Error);
    EXPECT_THROW(convert({{500, 400}, {1, 1}}), Error);
}

}  // namespace
}  // namespace lucerna
