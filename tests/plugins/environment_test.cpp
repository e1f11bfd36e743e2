// SPDX-License-Identifier: Apache-2.0
/// Light from infinity: pictures of the sphere, skies and suns.
#include "tests/plugins/emitters.h"

namespace lucerna {
namespace {

class Environments : public Emitters {
protected:
    const Scene& map(int width, int height, const std::function<Color(int, int)>& color,
                     const std::string& body = "") {
        write_map(*folder / "map.exr", width, height, color);
        return scene(ball + emitter("envmap", word("filename", "map.exr") + body));
    }
};

TEST_F(Environments, O17_C11_OneBrightTexel) {
    const Scene& s =
        map(1024, 512, [](int x, int y) { return Color(x == 300 && y == 128 ? 1e6f : 0); });
    EXPECT_TRUE(
        equivalent(irradiance(s, receiver({0, 0, 0}, {0, 1, 0}), 1000000), 18.824304, 0.01));
}

TEST_F(Environments, C11_ASunLeavesTheSkyItsLight) {
    const auto sky = [](int, int y) { return Color(y < 128 ? 1.0f : 0); };
    const auto sun_and_sky = [&](int x, int y) {
        return x == 300 && y == 64 ? Color(1e6f) : sky(x, y);
    };
    const Scene& s = map(512, 256, sun_and_sky);
    const RunningStatistics without_sun =
        irradiance(s, receiver({0, 0, 0}, {0, 1, 0}), 4000000, 1.01f);
    EXPECT_TRUE(mean_matches(without_sun, pi_d, 1e-3));
}

TEST_F(Environments, O17_SkyAndConstant) {
    const Receiver up = receiver({0, 0, 0}, {0, 1, 0});
    const Scene& sky = map(256, 128, [](int, int y) {
        return Color(Vector3d(0.5 + 0.5 * std::cos((y + 0.5) / 128 * pi_d)));
    });
    EXPECT_TRUE(equivalent(irradiance(sky, up, 1000000), 5 * pi_d / 6, 0.005));
    const Scene& white = map(
        64, 32, [](int, int) { return Color(1); }, number("scale", 2));
    EXPECT_TRUE(equivalent(irradiance(white, up, 1000000), 2 * pi_d, 0.01));
    double power = 0;
    for (const Light& light : white.lights()) power += light.emitter->bounds(light).power;
    EXPECT_NEAR(power, 2 * 4 * pi_d * pi_d * 3, 0.1);  // a box of 2³ has the radius √3
    const Scene& constant = scene(ball + emitter("constant", rgb("radiance", "2")));
    EXPECT_NEAR(irradiance(constant, up, 1000).mean(), 2 * pi_d, 1e-5);
    const Receiver both = receiver({0, 0, 0}, {0, 1, 0}, Sides::both);
    EXPECT_TRUE(equivalent(irradiance(constant, both, 400000), 2 * pi_d, 0.01));
}

std::string sun_direction(Vector3 d) {
    return fmt::format("<vector name='sun_direction' value='{}, {}, {}'/>", d.x, d.y, d.z);
}

/// Radiances of Mitsuba 3.9.1 (scalar_rgb).
TEST_F(Environments, SkyAndSunAreThoseOfMitsuba) {
    struct Sky {
        double turbidity, albedo;
        Vector3 sun, d;
        Color expected;
    };
    const Sky skies[] = {
        {3, 0.3, {0, 0, 1}, {0, 0, 1}, {0.18033f, 0.16222f, 0.18315f}},
        {3, 0.3, {0, 0.6f, 0.8f}, {0, -0.6f, 0.8f}, {0.02293f, 0.04557f, 0.09722f}},
        {3, 0.3, {0, 0.6f, 0.8f}, {1, 0, 0.05f}, {0.13569f, 0.18714f, 0.24048f}},
        {6, 0.3, {0, 0.6f, 0.8f}, {0, 0.5f, 0.8f}, {0.44723f, 0.44893f, 0.42564f}},
        {2, 0.3, {0, 0.95f, 0.31f}, {0, 0.5f, 0.8f}, {0.01949f, 0.03591f, 0.06174f}},
        {3, 0, {0, 0.6f, 0.8f}, {0, 0, 1}, {0.02477f, 0.03956f, 0.07867f}},
        {3, 0.3, {0, 0.6f, 0.8f}, {0, 0.6f, -0.8f}, {0, 0, 0}},
    };
    for (const Sky& sky : skies) {
        const Scene& s = scene(ball + emitter("sky", number("turbidity", sky.turbidity) +
                                                         rgb("albedo", fmt::to_string(sky.albedo)) +
                                                         sun_direction(sky.sun)));
        const Color found = s.environment(glm::normalize(sky.d));
        EXPECT_LT(glm::distance(found, sky.expected), 1e-3f * glm::length(sky.expected) + 1e-5f);
    }
    // Where the sun stands high; lower, Mitsuba's table of the sun is coarser.
    const std::map<double, Color> suns = {{3, {21689.34f, 18034.506f, 13663.243f}},
                                          {6, {19808.924f, 16313.815f, 12424.314f}}};
    for (const auto& [turbidity, expected] : suns) {
        const Scene& s = scene(
            ball + emitter("sun", number("turbidity", turbidity) + sun_direction({0, 0.6f, 0.8f})));
        const Vector3 d = glm::normalize(Vector3(0, 0.6f, 0.8f));
        EXPECT_LT(glm::distance(s.environment(d), expected), 2e-3f * glm::length(expected));
        EXPECT_EQ(s.environment(glm::normalize(d + Vector3(0.006f, 0, 0))), Color(0));
        EXPECT_GT(s.environment(glm::normalize(d + Vector3(0.004f, 0, 0))).x, 0);
    }
}

TEST_F(Environments, TheSunStandsWhereTheAlmanacSays) {
    // Mitsuba's default, 10 July 2010, 15:00 in Tokyo; +x is south, +y west.
    const Scene& tokyo = scene(ball + emitter("sun"));
    EXPECT_GT(tokyo.environment({0.05138545f, 0.69174796f, 0.7203085f}).x, 0);
    // Noon at an equinox on the equator: in the zenith, but for the equation of time (7.4 minutes).
    const std::string equator = number("latitude", 0) + number("longitude", 0) +
                                number("timezone", 0) + whole("year", 2010) + whole("month", 3) +
                                whole("day", 20) + number("hour", 12) + number("minute", 7.4);
    EXPECT_GT(scene(ball + emitter("sun", equator)).environment({0, 0, 1}).x, 0);
    const std::string y_up = to_world("<rotate x='1' angle='-90'/>");
    EXPECT_GT(scene(ball + emitter("sun", equator + y_up)).environment({0, 1, 0}).x, 0);
    EXPECT_EQ(scene(ball + emitter("sun", equator + y_up)).environment({0, 0, 1}).x, 0);
}

TEST_F(Environments, SkiesAreSampledAsTheyShine) {
    const std::string high = sun_direction({0.3f, 0.2f, 0.9f}), low = sun_direction({1, 0, 0.08f});
    const std::string y_up = to_world("<rotate x='1' angle='-90'/>");
    for (const std::string& xml :
         {emitter("sunsky", high), emitter("sky", low),
          emitter("sunsky", sun_direction({1, 0.08f, 0}) + y_up),
          emitter("sunsky", high + number("sun_aperture", 20) + number("turbidity", 8))}) {
        SCOPED_TRACE(xml);
        const Scene& s = scene(ball + xml);
        const Receiver at = receiver({0, 0, 0}, {0.1f, 0.3f, 1}, Sides::both);
        std::array<RunningStatistics, moment_count> sampled, seen;
        const DiscreteDistribution choice = by_power(s);
        Rng rng(3);
        RunningStatistics power;
        double bound = 0;
        for (const Light& light : s.lights()) bound += light.emitter->bounds(light).power;
        for (int i = 0; i < 200000; ++i) {
            const std::uint32_t k = choice.sample(rng.next_double());
            const Light& light = s.lights()[k];
            const auto sample = light.emitter->sample_li(light, at, rng.next_float2());
            std::array<double, moment_count> g{};
            if (sample) {
                g = moments(sample->wi);
                EXPECT_EQ(s.light_along(0, sample->wi), k);
                EXPECT_EQ(s.environment(sample->wi), sample->radiance);
                EXPECT_NEAR(light.emitter->pdf_li(light, at, sample->wi, nullptr), sample->pdf,
                            2e-3f * sample->pdf);
                const Bounds3 box = light.emitter->bounds(light).directions;
                EXPECT_TRUE(box.contains(sample->wi));
            }
            const double weight =
                sample
                    ? static_cast<double>(luminance(sample->radiance) / sample->pdf) / choice.pmf(k)
                    : 0;
            for (std::size_t m = 0; m < moment_count; ++m) sampled[m].add(weight * g[m]);
            const Vector2 u = rng.next_float2(), v = rng.next_float2();
            const auto e = light.emitter->sample_emission(light, u, v);
            power.add(e ? static_cast<double>(luminance(e->power)) / choice.pmf(k) : 0);
        }
        EXPECT_TRUE(equivalent(power, bound, 0.01));
        // Seen from everywhere, half of the rays close to the sun.
        const Vector3 sun = [&] {
            Vector3 brightest(0);
            for (std::uint32_t k = 0; k < s.lights().size(); ++k) {
                const Light& light = s.lights()[k];
                const auto one = light.emitter->sample_li(light, at, {0.5f, 0.5f});
                if (!one) continue;
                const bool brighter =
                    brightest == Vector3(0) ||
                    luminance(one->radiance) > luminance(s.environment(brightest));
                if (brighter) brightest = one->wi;
            }
            return brightest;
        }();
        constexpr float cap = 0.02f;  // 1 − cos
        const double cone = 2 * pi_d * static_cast<double>(cap);
        for (int i = 0; i < 1000000; ++i) {
            const bool near = i % 2 == 0;
            const Vector2 u = rng.next_float2();
            const Vector3 w = near
                                  ? Frame::from_normal(sun).to_world(square_to_uniform_cone(u, cap))
                                  : square_to_uniform_sphere(u);
            const double density = 0.5 / (4 * pi_d) + (glm::dot(w, sun) > 1 - cap ? 0.5 / cone : 0);
            const auto g = moments(w);
            const double value = static_cast<double>(luminance(s.environment(w))) / density;
            for (std::size_t m = 0; m < moment_count; ++m) seen[m].add(value * g[m]);
        }
        for (std::size_t m = 0; m < moment_count; ++m) {
            const double error = std::hypot(sampled[m].standard_error(), seen[m].standard_error());
            EXPECT_NEAR(sampled[m].mean(), seen[m].mean(), 4.5 * error) << m;
        }
    }
}

TEST_F(Environments, TheSizeOfTheSunChangesNoIrradiance) {
    const auto cast = [&](double aperture) {
        const std::string body = number("sun_aperture", aperture) + sun_direction({0, 0, 1});
        return irradiance(scene(ball + emitter("sun", body)), receiver({0, 0, 0}, {0, 0, 1}), 1000);
    };
    // Up to the mean cosine over the disk, (1 + cos) / 2.
    const double one = cast(0.1).mean();
    EXPECT_NEAR(cast(0.5358).mean() / one, 1, 1e-4);
    EXPECT_NEAR(cast(20).mean() / one, (1 + std::cos(10 * pi_d / 180)) / 2, 2e-3);
}

TEST_F(Environments, C12_BlackIsBlack) {
    const Scene& s = map(8, 4, [](int, int) { return Color(0); });
    const Light& light = s.lights()[0];
    EXPECT_EQ(irradiance(s, receiver({0, 0, 0}, {0, 1, 0}), 100).mean(), 0);
    EXPECT_EQ(light.emitter->bounds(light).power, 0);
    EXPECT_EQ(light.emitter->pdf_li(light, receiver({}, {0, 1, 0}), {1, 0, 0}, nullptr), 0);
    EXPECT_EQ(s.environment({0, 0, 1}), Color(0));
    EXPECT_FALSE(light.emitter->sample_emission(light, {0.5f, 0.5f}, {0.5f, 0.5f}));
}

TEST_F(Environments, C13_OneTexelPolesAndSeam) {
    for (const Vector2i size : {Vector2i(1, 1), Vector2i(7, 1), Vector2i(1, 5), Vector2i(2, 2)}) {
        const Scene& s = map(size.x, size.y, [](int, int) { return Color(1); });
        EXPECT_TRUE(equivalent(irradiance(s, receiver({}, {1, 2, 0}), 400000), pi_d, 0.01));
        for (const Vector3 d : {Vector3(0, 1, 0), Vector3(0, -1, 0), Vector3(0, 0, -1)}) {
            EXPECT_LT(glm::distance(s.environment(d), Color(1)), 1e-6f);
        }
    }
    const Scene& stripes = map(4, 2, [](int x, int) { return Color(static_cast<float>(x)); });
    // Left and right edges meet at −z, halfway between the last and the first texel.
    for (const float x : {-1e-5f, 0.0f, 1e-5f}) {
        EXPECT_NEAR(stripes.environment(glm::normalize(Vector3(x, 0, -1))).x, 1.5f, 1e-3f);
    }
    const Light& light = stripes.lights()[0];
    const Receiver anywhere = receiver({}, {0, 1, 0});
    EXPECT_TRUE(std::isfinite(light.emitter->pdf_li(light, anywhere, {0, 1, 0}, nullptr)));
}

TEST_F(Environments, DirectionsAreThoseOfMitsuba) {
    const Scene& s = map(
        8, 4, [](int x, int y) { return Color(static_cast<float>(x), static_cast<float>(y), 0); });
    EXPECT_NEAR(s.environment({0, 1, 0}).y, 0, 1e-5f);
    EXPECT_NEAR(s.environment({0, -1, 0}).y, 3, 1e-5f);
    EXPECT_NEAR(s.environment({1, 0, 0}).x, 1.5f, 1e-5f);
    EXPECT_NEAR(s.environment({0, 0, 1}).x, 3.5f, 1e-5f);
    EXPECT_NEAR(s.environment({-1, 0, 0}).x, 5.5f, 1e-5f);
    // Rows cover equal angles: 22.5 degrees below +y lies the centre of the first of four.
    for (const int row : {0, 1, 2, 3}) {
        const double theta = (row + 0.5) * std::numbers::pi / 4;
        const Vector3 d(Vector3d(std::sin(theta), std::cos(theta), 0));
        EXPECT_NEAR(s.environment(d).y, static_cast<float>(row), 1e-5f);
    }
    const Scene& turned = map(
        8, 4, [](int, int y) { return Color(static_cast<float>(y)); },
        to_world("<rotate x='1' angle='90'/>"));
    EXPECT_NEAR(turned.environment({0, 0, 1}).x, 0, 1e-5f);
    EXPECT_NE(refusal(emitter("envmap", word("filename", "noise.exr") + to_world("<scale x='2'/>")),
                      folder->path()),
              "");
}

TEST_F(Environments, C14_SamplingFollowsTheDensity) {
    // The map's rows and columns are borders of cells of the test when its up is +z.
    const std::string up = to_world("<rotate x='1' angle='90'/>");
    for (const std::string& xml :
         {emitter("envmap", word("filename", "noise.exr") + up), emitter("constant")}) {
        SCOPED_TRACE(xml);
        const Scene& s = scene(ball + xml);
        const Light& light = s.lights()[0];
        for (const Sides sides : {Sides::front, Sides::back, Sides::both}) {
            const Receiver at = receiver({}, {0, 0, 1}, sides);
            const auto sample = [&](Vector2 u) -> std::optional<Vector3> {
                const auto li = light.emitter->sample_li(light, at, u);
                return li ? std::optional(li->wi) : std::nullopt;
            };
            const auto pdf = [&](Vector3 w) {
                return static_cast<double>(light.emitter->pdf_li(light, at, w, nullptr));
            };
            EXPECT_TRUE(
                sampling_matches_pdf(sample, pdf, {.grid = {.samples = 200000}, .tests = 6}));
        }
    }
}

/// A picture that is large enough for patches: dim noise, a sun, and a black rectangle.
Color sky_with_sun(int x, int y) {
    if (x == 200 && y == 40) return Color(1e4f);
    if (x < 40 && y > 80) return Color(0);
    const auto noise =
        static_cast<float>(hash64({static_cast<std::uint32_t>(x + 1000 * y), 7}) >> 40);
    return Color(noise * 0x1p-24f, 0.5f, y < 64 ? 2.0f : 0.1f);
}

TEST_F(Environments, PatchesTogetherAreTheMap) {
    const Scene& s = map(256, 128, sky_with_sun, to_world("<rotate x='1' y='2' angle='50'/>"));
    const auto count = static_cast<std::uint32_t>(s.lights().size());
    ASSERT_GT(count, 100u);
    ASSERT_EQ(s.infinite_lights().size(), 1u);
    const Emitter& e = *s.lights()[0].emitter;
    ASSERT_EQ(e.light_count(), count);
    const Receiver at = receiver({}, {0, 1, 0});
    double power = 0;
    for (const Light& light : s.lights()) power += e.bounds(light).power;
    RunningStatistics radiance;
    Rng rng(6);
    for (int i = 0; i < 200000; ++i) {
        const Vector3 d = square_to_uniform_sphere(rng.next_float2());
        const std::uint32_t along = s.light_along(0, d);
        ASSERT_LT(along, count);
        EXPECT_TRUE(e.bounds(s.lights()[along]).directions.contains(d));
        const float pdf = e.pdf_li(s.lights()[along], at, d, nullptr);
        EXPECT_TRUE(pdf > 0 || s.environment(d) == Color(0));
        const auto luminous = static_cast<double>(luminance(s.environment(d)));
        radiance.add(luminous < 10 ? luminous : 0);  // but for the sun
        if (i >= 200) continue;
        for (std::uint32_t k = 0; k < count; ++k) {
            if (k == along) continue;
            EXPECT_EQ(e.pdf_li(s.lights()[k], at, d, nullptr), 0);
        }
    }
    // A texel of 10⁴, over its solid angle in the row 40.
    const double sun = 1e4 * 2 * pi_d / 256 * pi_d / 128 * std::sin(40.5 * pi_d / 128);
    const double area = pi_d * 3;  // of the sphere around a box of 2³
    EXPECT_NEAR(power / area, sun + 4 * pi_d * radiance.mean(), 0.01 * power / area);
}

TEST_F(Environments, PatchesAreSampledAsTheySay) {
    const Scene& s = map(256, 128, sky_with_sun);
    const Receiver at = receiver({}, {0, 1, 0});
    Rng rng(8);
    for (std::uint32_t k = 0; k < s.lights().size(); ++k) {
        const Light& light = s.lights()[k];
        const LightBounds bounds = light.emitter->bounds(light);
        RunningStatistics radiance;
        for (int i = 0; i < 1000; ++i) {
            const auto li = light.emitter->sample_li(light, at, rng.next_float2());
            const auto photon =
                light.emitter->sample_emission(light, rng.next_float2(), rng.next_float2());
            if (!li || !photon) continue;
            EXPECT_TRUE(bounds.directions.contains(li->wi));
            EXPECT_TRUE(bounds.directions.contains(-photon->ray.d));
            radiance.add(static_cast<double>(luminance(li->radiance) / li->pdf));
            if (s.light_along(0, li->wi) != k) continue;  // rounded beyond the border
            const float pdf = light.emitter->pdf_li(light, at, li->wi, nullptr);
            EXPECT_NEAR(pdf, li->pdf, 2e-3f * li->pdf);
        }
        if (radiance.count() == 0) continue;  // black
        const double expected =
            bounds.power / static_cast<double>(pi * sqr(1.0001f * std::sqrt(3.0f)));
        EXPECT_TRUE(mean_matches(radiance, expected, 1e-5)) << k;
    }
}

TEST_F(Environments, C14_PatchesFollowTheDensity) {
    const Scene& s = map(256, 128, [](int x, int y) {
        const Color c = sky_with_sun(x, y);
        return glm::min(c, Color(2));
    });
    const auto count = static_cast<float>(s.lights().size());
    const Receiver at = receiver({}, {0, 0, 1});
    const auto sample = [&](Vector2 u) -> std::optional<Vector3> {
        const float place = u.x * count;
        const auto k = std::min(static_cast<std::size_t>(place), s.lights().size() - 1);
        const Light& light = s.lights()[k];
        const auto li = light.emitter->sample_li(
            light, at, {std::min(place - std::floor(place), one_minus_epsilon), u.y});
        return li ? std::optional(li->wi) : std::nullopt;
    };
    const auto pdf = [&](Vector3 w) {
        const Light& light = s.lights()[s.light_along(0, w)];
        return static_cast<double>(light.emitter->pdf_li(light, at, w, nullptr) / count);
    };
    EXPECT_TRUE(sampling_matches_pdf(sample, pdf, {.grid = {.samples = 100000}}));
}

TEST_F(Environments, SmallAndBlackPicturesAreOneLight) {
    EXPECT_EQ(map(56, 16, [](int, int) { return Color(1); }).lights().size(), 1u);
    EXPECT_EQ(map(256, 128, [](int, int) { return Color(0); }).lights().size(), 1u);
}

TEST_F(Environments, C14_LightComesOnlyFromWhereItIsSampled) {
    const Scene& s = map(16, 8, [](int x, int y) { return Color(x == 0 && y == 3 ? 1.0f : 0); });
    const Light& light = s.lights()[0];
    Rng rng(3);
    for (int i = 0; i < 100000; ++i) {
        const Vector3 d = square_to_uniform_sphere(rng.next_float2());
        const float pdf = light.emitter->pdf_li(light, receiver({}, {0, 1, 0}), d, nullptr);
        EXPECT_TRUE(pdf > 0 || s.environment(d).x == 0);
        const auto li = light.emitter->sample_li(light, receiver({}, {0, 1, 0}), rng.next_float2());
        EXPECT_LT(glm::distance(s.environment(li->wi), li->radiance), 1e-4f);
    }
}

TEST_F(Environments, C15_WrongTexelsAreCountedAndBlack) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Scene& s = map(8, 4, [&](int x, int y) {
        if (x == 3 && y == 1) return Color(nan, 1, 1);
        if (x == 4 && y == 1) return Color(1, -1, 1);
        if (x == 5 && y == 2) return Color(infinity);
        return Color(1);
    });
    EXPECT_NE(workshop_.warnings().find("3 of 32 texels are negative or not finite"),
              std::string::npos);
    Rng rng(1);
    for (int i = 0; i < 10000; ++i) {
        const Color c = s.environment(square_to_uniform_sphere(rng.next_float2()));
        EXPECT_TRUE(is_finite(c) && min_component(c) >= 0 && max_component(c) <= 1.0001f);
    }
}

}  // namespace
}  // namespace lucerna
