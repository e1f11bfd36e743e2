// SPDX-License-Identifier: Apache-2.0
#include "core/description/values.h"

#include "core/base/error.h"

#include <gtest/gtest.h>

#include <clocale>
#include <initializer_list>

namespace lucerna {
namespace {

template <typename Parse>
std::string error_of(Parse parse) {
    try {
        parse();
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Values, Numbers) {
    EXPECT_EQ(parse_float("1.5"), 1.5);
    EXPECT_EQ(parse_float(".5"), 0.5);
    EXPECT_EQ(parse_float("5."), 5);
    EXPECT_EQ(parse_float("+2"), 2);
    EXPECT_EQ(parse_float("-02.293"), -2.293);
    EXPECT_EQ(parse_float(" 1e-3\n"), 1e-3);
    EXPECT_EQ(parse_float("-0"), 0);
    EXPECT_EQ(parse_float("3.4028234e38"), 3.4028234e38);
    EXPECT_EQ(parse_integer("-12"), -12);
    EXPECT_EQ(parse_integer(" +12 "), 12);
    EXPECT_EQ(parse_integer("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
}

TEST(Values, K4_what_is_no_number_is_refused) {
    for (const char* text :
         {"",    " ",   "abc",  "1.5abc", "1 5",   "1;5", "1..5", "--5",       "+-5", "++5",
          "+",   "-",   ".",    "e5",     "1e",    "1e+", "0x10", "#5",        "1,",  ",1",
          "1/2", "50%", "true", "1_000",  "\"1\"", "1f",  "٣",    "1\xc2\xa0", "$x",  "1.5.2"}) {
        EXPECT_THROW(parse_float(text), Error) << text;
        EXPECT_THROW(parse_integer(text), Error) << text;
    }
    for (const char* text : {"1.0", "1e3", "1.", "0.5"}) {
        EXPECT_THROW(parse_integer(text), Error) << text;
    }
    EXPECT_EQ(error_of([] { parse_float("1.5m"); }), "expected a number, not \"1.5m\"");
}

TEST(Values, K5_the_locale_does_not_matter) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    bool found = false;
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE", "fr_FR"}) {
        found = found || std::setlocale(LC_ALL, name);
    }
    const double value = parse_float("1.5");
    const std::string message = error_of([] { parse_float("1,5"); });
    std::setlocale(LC_ALL, before.c_str());
    EXPECT_EQ(value, 1.5);
    EXPECT_EQ(message, "expected a number, not \"1,5\"; the decimal separator is a point");
    if (!found) GTEST_SKIP() << "no locale with a decimal comma is installed: C was tested";
}

TEST(Values, K6_numbers_are_finite_and_fit_into_a_float) {
    for (const char* text : {"nan", "inf", "-inf", "NaN", "infinity", "nan(1)", "1e400", "-1e400",
                             "1e39", "1e-400", "1e-50"}) {
        EXPECT_THROW(parse_float(text), Error) << text;
    }
    EXPECT_NO_THROW(parse_float("1e-44"));  // a subnormal float
    EXPECT_NO_THROW(parse_numbers("1e-50 2"));
    EXPECT_THROW(parse_numbers("1 nan"), Error);
}

TEST(Values, K7_integers_do_not_wrap_or_clamp) {
    EXPECT_EQ(parse_integer("4294967296"), 4294967296);
    EXPECT_THROW(parse_integer("9223372036854775808"), Error);
    EXPECT_THROW(parse_integer("99999999999999999999"), Error);
    EXPECT_THROW(parse_integer("-9223372036854775809"), Error);
}

TEST(Values, K8_booleans_are_two_words) {
    EXPECT_TRUE(parse_boolean("true"));
    EXPECT_FALSE(parse_boolean(" false "));
    EXPECT_TRUE(parse_boolean("True"));
    EXPECT_FALSE(parse_boolean("FALSE"));
    for (const char* text : {"", "trueish", "yes", "1", "0", "1.5", "tru", "true false"}) {
        EXPECT_THROW(parse_boolean(text), Error) << text;
    }
}

TEST(Values, Lists) {
    EXPECT_EQ(parse_numbers("1, 2,3 4\t\n5 ,6"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(parse_triple("1 2 3"), Vector3d(1, 2, 3));
    EXPECT_EQ(parse_triple("1, 2, 3, "), Vector3d(1, 2, 3));
    for (const char* text :
         {"1,,2 3", "1, 2, 3,,", ",1 2 3", "1, 2,", "1 2", "1 2 3 4", "1;2;3", ""}) {
        EXPECT_THROW(parse_triple(text), Error) << text;
    }
}

TEST(Values, Colours) {
    EXPECT_EQ(parse_rgb("0.5"), ColorD(0.5));
    EXPECT_EQ(parse_rgb("0.1, 0.2 0.3"), ColorD(0.1, 0.2, 0.3));
    EXPECT_EQ(parse_rgb("#ffffff"), ColorD(1));
    EXPECT_EQ(parse_rgb("#000000"), ColorD(0));
    // IEC 61966-2-1 by hand: ((0.5 + 0.055) / 1.055)^2.4, and 0.04 / 12.92 in the linear part.
    EXPECT_NEAR(parse_srgb("0.5").x, 0.21404114048223255, 1e-15);
    EXPECT_NEAR(parse_srgb("0.04").x, 0.0030959752321981426, 1e-15);
    EXPECT_EQ(parse_linear_rgb("#ff3300"), ColorD(1, 0.2, 0));
    EXPECT_EQ(parse_linear_rgb("0.1, 0.2 0.3"), ColorD(0.1, 0.2, 0.3));
    const ColorD picked = parse_rgb("#c08040");
    EXPECT_NEAR(picked.x, 0.52711513, 1e-8);
    EXPECT_NEAR(picked.y, 0.21586050, 1e-8);
    EXPECT_NEAR(picked.z, 0.05126946, 1e-8);
    EXPECT_EQ(parse_srgb("#C08040"), picked);
    for (const char* text :
         {"#c0804", "#c080400", "#c0804g", "#", "red", "1 2", "1 2 3 4", "#-1-1-1", "# 11111"}) {
        EXPECT_THROW(parse_rgb(text), Error) << text;
        EXPECT_THROW(parse_srgb(text), Error) << text;
    }
}

TEST(Values, Matrices) {
    const Matrix4d m = parse_matrix("1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 ");
    EXPECT_EQ(m[0], glm::dvec4(1, 5, 9, 13));  // GLM stores columns
    EXPECT_EQ(m[3], glm::dvec4(4, 8, 12, 16));
    const Matrix4d linear = parse_matrix("1 2 3 4 5 6 7 8 9");
    EXPECT_EQ(linear[0], glm::dvec4(1, 4, 7, 0));
    EXPECT_EQ(linear[3], glm::dvec4(0, 0, 0, 1));
    EXPECT_THROW(parse_matrix("1 2 3 4"), Error);
}

TEST(Values, Spectra) {
    const Spectrum spectrum = parse_spectrum_list("400:0.1, 500 : 0.2 600:-1e-2");
    EXPECT_EQ(spectrum.wavelengths, (std::vector<double>{400, 500, 600}));
    EXPECT_EQ(spectrum.values, (std::vector<double>{0.1, 0.2, -0.01}));
    EXPECT_EQ(parse_spectrum_list("400:1,").values, std::vector<double>{1});
    for (const char* text : {"", "400", "400:", ":1", "400:1,,", "400:1:2", "400=1", "400:1 500"}) {
        EXPECT_THROW(parse_spectrum_list(text), Error) << text;
    }
}

TEST(Values, LongTextsAreShortenedInMessages) {
    const std::string message = error_of([] { parse_float(std::string(1000, 'x')); });
    EXPECT_LT(message.size(), 120u);
    // Not within a character: é has two bytes.
    std::string accents = "x";
    for (int i = 0; i < 100; ++i) accents += "\xc3\xa9";
    EXPECT_EQ(quote(accents).substr(quote(accents).size() - 6), "\xc3\xa9...\"");
}

}  // namespace
}  // namespace lucerna
