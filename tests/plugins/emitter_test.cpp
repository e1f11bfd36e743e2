// SPDX-License-Identifier: Apache-2.0
/// What every emitter must satisfy, tried on all that the registry finds, and closed forms of the
/// light that each casts.
#include "plugins/commands/contracts/emitter.h"
#include "core/image/exr.h"
#include "core/image/png.h"
#include "core/math/distribution.h"
#include "core/math/warp.h"
#include "core/scene/scene.h"
#include "tests/plugins/workshop.h"
#include "tests/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

namespace lucerna {
namespace {

constexpr double pi_d = std::numbers::pi;

std::string emitter(const std::string& type, const std::string& body = "") {
    return fmt::format("<emitter type='{}'>{}</emitter>", type, body);
}
std::string shape(const std::string& type, const std::string& body) {
    return fmt::format("<shape type='{}'>{}</shape>", type, body);
}
std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}
std::string rgb(const std::string& name, const std::string& value) {
    return fmt::format("<rgb name='{}' value='{}'/>", name, value);
}
const std::string glow = emitter("area", rgb("radiance", "1"));
const std::string ball = shape("sphere", "");
const std::string facing_down = "<rotate x='1' angle='180'/>";

void write_map(const std::filesystem::path& path, int width, int height,
               const std::function<Color(int, int)>& color) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.set_rgb(x, y, color(x, y));
    }
    ImageFile file;
    add_layer(file, image);
    write_exr(path, file);
}

Receiver receiver(Vector3 p, Vector3 n, Sides sides = Sides::front) {
    return {.p = p, .n = glm::normalize(n), .ns = glm::normalize(n), .sides = sides};
}

/// One draw of one light, each light with the same probability.
struct Draw {
    std::uint32_t light;
    std::optional<LightSample> sample;
};
Draw draw(const Scene& scene, const Receiver& from, Rng& rng) {
    const auto n = static_cast<std::uint32_t>(scene.lights().size());
    const std::uint32_t light = rng.next_uint() % n;
    const Vector2 u = rng.next_float2();
    const Light& chosen = scene.lights()[light];
    return {light, chosen.emitter->sample_li(chosen, from, u)};
}

/// Lights in proportion to their power; all alike if none has any.
DiscreteDistribution by_power(const Scene& scene) {
    std::vector<double> powers;
    double total = 0;
    for (const Light& light : scene.lights()) {
        powers.push_back(light.emitter->bounds(light).power);
        total += powers.back();
    }
    if (!(total > 0)) std::fill(powers.begin(), powers.end(), 1.0);
    return DiscreteDistribution(powers);
}

/// Irradiance at a receiver that nothing blocks [W/m²], by light of luminance up to `most`.
RunningStatistics irradiance(const Scene& scene, const Receiver& at, int samples = 100000,
                             float most = infinity) {
    Rng rng(7);
    RunningStatistics e;
    const DiscreteDistribution choice = by_power(scene);
    for (int i = 0; i < samples; ++i) {
        const std::uint32_t k = choice.sample(rng.next_double());
        const Vector2 u = rng.next_float2();
        const Light& light = scene.lights()[k];
        const auto s = light.emitter->sample_li(light, at, u);
        const bool counts = s && luminance(s->radiance) <= most;
        const float cosine = counts ? std::max(glm::dot(s->wi, at.ns), 0.0f) : 0;
        e.add(counts ? static_cast<double>(luminance(s->radiance) * cosine / s->pdf) / choice.pmf(k)
                     : 0);
    }
    return e;
}

/// What emitters need beside their defaults.
const std::map<std::string, std::string> bodies = {
    {"envmap", word("filename", "noise.exr")},
};

class Emitters : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        Rng rng(11);
        write_map(*folder / "noise.exr", 16, 8, [&](int x, int y) {
            const float r = rng.next_float(), g = rng.next_float(), b = rng.next_float();
            return x == 13 && y == 5 ? Color(40, 30, 20) : Color(r * r * r, g * g, b);
        });
        write_png(*folder / "half.png",
                  {.width = 2, .height = 1, .pixels = {255, 255, 255, 0, 0, 0}});
        std::vector<std::uint8_t> upper_left(12);
        std::fill_n(upper_left.begin(), 3, std::uint8_t{255});
        write_png(*folder / "upper_left.png", {.width = 2, .height = 2, .pixels = upper_left});
    }
    static void TearDownTestSuite() { delete folder; }

    /// A scene of a sphere of radius 1 and an emitter; for `area` the sphere is it.
    const Scene& with(const std::string& type, const std::string& body = "") {
        const auto more = bodies.find(type);
        const std::string xml = emitter(type, (more == bodies.end() ? "" : more->second) + body);
        return scene(type == "area" ? shape("sphere", xml) : ball + xml);
    }
    const Scene& scene(const std::string& xml) { return workshop_.make_scene(xml); }

    static inline TemporaryFolder* folder = nullptr;
    Workshop workshop_{folder->path()};
};

TEST_F(Emitters, AgreeOnWhatTheyAre) {
    const auto names = workshop_.registry().names("emitter");
    EXPECT_GE(names.size(), 6u);
    for (const std::string& name : names) {
        SCOPED_TRACE(name);
        const Scene& s = with(name, number("sampling_weight", 2));
        EXPECT_NE(workshop_.warnings().find("\"sampling_weight\" has no effect"),
                  std::string::npos);
        if (name == "sky" || name == "sunsky") {
            EXPECT_GT(s.lights().size(), 100u);  // parts of the sky
        } else {
            ASSERT_EQ(s.lights().size(), 1u);
        }
        EXPECT_TRUE(holds(contracts::emitter_nature(contracts::EmitterTrial(s), {})));
    }
}

TEST_F(Emitters, C21_ExtremeRandomNumbersAreHarmless) {
    for (const std::string& name : workshop_.registry().names("emitter")) {
        SCOPED_TRACE(name);
        const contracts::EmitterTrial trial(with(name));
        EXPECT_TRUE(holds(contracts::emitter_extreme_numbers(trial)));
    }
}

/// Scenes of one emitting shape, and where it is looked at from.
struct AreaCase {
    std::string xml;
    std::vector<Vector3> from;
};

std::vector<AreaCase> area_cases() {
    const std::vector<Vector3> around = {
        {0, 0, 3}, {1.5f, 0.2f, 0.6f}, {0.3f, -0.2f, 1.02f}, {-2, 1, -1}};
    const std::string uneven =
        to_world("<scale x='0.5' y='1.5' z='0.8'/><rotate y='1' angle='40'/>");
    return {
        {shape("sphere", glow), around},
        {shape("sphere", glow + "<boolean name='flip_normals' value='true'/>"),
         {{0, 0, 0}, {0.3f, 0.4f, 0.1f}, {0, 0, 0.99f}}},
        {shape("rectangle", glow), {{0, 0, 3}, {0.3f, 0.4f, 0.05f}, {2, 0, 0.1f}, {0, 0, -1}}},
        {shape("rectangle", glow + uneven), around},
        {shape("disk", glow + uneven), around},
        {shape("disk", glow), {{0, 0, 1}, {0.9f, 0, 0.02f}, {3, 1, 0.5f}}},
        {shape("cylinder", glow), {{3, 0, 0.5f}, {1.02f, 0, 0.5f}, {0, 2, 3}}},
        {shape("cube", glow + uneven), {{0, 0, 3}, {2, 1, 1}, {0.2f, 0.1f, 2}}},
        {shape("cube", glow + "<boolean name='flip_normals' value='true'/>"), {{0.3f, 0, 0.9f}}}};
}

/// Functions that a density must weight rightly: moments of the direction.
constexpr std::size_t moment_count = 5;
std::array<double, moment_count> moments(Vector3 w) {
    const Vector3d d(w);
    return {1, 1 + d.x, 1 + d.y, 1 + d.z, sqr(d.x - d.z)};
}

TEST_F(Emitters, C2_C3_C8_C23_AreaSamplingCoversWhatRaysSee) {
    for (const AreaCase& c : area_cases()) {
        const Scene& s = scene(c.xml);
        for (const Vector3 p : c.from) {
            SCOPED_TRACE(c.xml + fmt::format("\nfrom {} {} {}", p.x, p.y, p.z));
            const Receiver at = receiver(p, {0.2f, -0.3f, -1}, Sides::both);
            std::array<RunningStatistics, moment_count> sampled, seen;
            Rng rng(3);
            for (int i = 0; i < 20000; ++i) {
                const auto [light, sample] = draw(s, at, rng);
                const auto g = sample ? moments(sample->wi) : std::array<double, moment_count>{};
                const double weight = sample ? static_cast<double>(s.lights().size()) /
                                                   static_cast<double>(sample->pdf)
                                             : 0;
                for (std::size_t k = 0; k < moment_count; ++k) sampled[k].add(weight * g[k]);
            }
            for (int i = 0; i < 100000; ++i) {
                const Vector3 w = square_to_uniform_sphere(rng.next_float2());
                const auto hit = s.intersect({.o = p, .d = w});
                const bool front = hit && glm::dot(hit->n, w) < 0;
                const auto g = moments(w);
                for (std::size_t k = 0; k < moment_count; ++k) {
                    seen[k].add(front ? 4 * pi_d * g[k] : 0);
                }
            }
            for (std::size_t k = 0; k < moment_count; ++k) {
                const double error =
                    std::hypot(sampled[k].standard_error(), seen[k].standard_error());
                EXPECT_NEAR(sampled[k].mean(), seen[k].mean(), 4.5 * error + 1e-5) << k;
            }
        }
    }
}

TEST_F(Emitters, SampledDensityIsTheEvaluatedOne) {
    for (const AreaCase& c : area_cases()) {
        const Scene& s = scene(c.xml);
        for (const Vector3 p : c.from) {
            SCOPED_TRACE(c.xml + fmt::format("\nfrom {} {} {}", p.x, p.y, p.z));
            const Receiver at = receiver(p, {0.2f, -0.3f, -1}, Sides::both);
            Rng rng(4);
            int compared = 0, different = 0;
            for (int i = 0; i < 5000; ++i) {
                const auto [light, sample] = draw(s, at, rng);
                if (!sample) continue;
                const auto hit = s.intersect({.o = p, .d = sample->wi});
                if (!hit || Scene::light_of(*hit) != light) continue;  // at an edge
                const Light& l = s.lights()[light];
                const float pdf = l.emitter->pdf_li(l, at, sample->wi, &*hit);
                ++compared;
                different += std::abs(pdf - sample->pdf) > 2e-3f * sample->pdf;
                EXPECT_EQ(l.emitter->radiance(*hit, -sample->wi), sample->radiance);
                EXPECT_LT(glm::distance(hit->p, sample->p), 1e-3f);
                EXPECT_EQ(l.emitter->radiance(*hit, sample->wi), Color(0));
            }
            EXPECT_LE(different, compared / 100);
        }
    }
}

TEST_F(Emitters, EmissionCarriesThePowerOfTheBoundsAndTheLightThatIsSampled) {
    const std::string spot = emitter("spot", number("cutoff_angle", 50));
    const std::string wide = number("fov", 100) + "<texture name='irradiance' type='bitmap'>" +
                             word("filename", "half.png") + "</texture>";
    for (const std::string& xml :
         {shape("sphere", glow), shape("cube", glow + to_world("<scale x='3'/>")),
          shape("disk", emitter("area", rgb("radiance", "1 2 3"))),
          shape("rectangle", emitter("area", "<texture name='radiance' type='bitmap'>" +
                                                 word("filename", "half.png") + "</texture>")),
          ball + emitter("point"), ball + spot, ball + emitter("projector", wide),
          ball + emitter("directional"), ball + emitter("constant"),
          ball + emitter("envmap", word("filename", "noise.exr"))}) {
        SCOPED_TRACE(xml);
        const contracts::EmitterTrial trial(scene(xml));
        EXPECT_TRUE(holds(contracts::emitter_power(trial, {})));
        EXPECT_TRUE(holds(contracts::emitter_bounds(trial, {})));
        // Closed shapes stand in their own light.
        if (xml.find("'cube'") != std::string::npos) continue;
        EXPECT_TRUE(holds(contracts::emitter_photons(trial, {})));
        EXPECT_TRUE(holds(contracts::emitter_densities(trial, {})));
        EXPECT_TRUE(holds(contracts::emitter_coverage(trial, {})));
    }
}

TEST_F(Emitters, EmissionOfManyLanesIsThatOfEach) {
    const std::string picture = emitter("area", "<texture name='radiance' type='bitmap'>" +
                                                    word("filename", "half.png") + "</texture>");
    const std::string place = to_world("<rotate x='1' angle='20'/><translate x='3' y='-1'/>");
    std::vector<std::string> cases = {ball + emitter("point"), ball + emitter("spot"),
                                      ball + emitter("directional"), ball + emitter("constant"),
                                      ball + emitter("envmap", word("filename", "noise.exr"))};
    for (const char* type : {"sphere", "disk", "cylinder", "rectangle", "cube"}) {
        for (const std::string& light : {glow, picture}) {
            cases.push_back(shape(type, light + place));
            cases.push_back(shape(type, light + place +
                                            "<boolean name='flip_normals' "
                                            "value='true'/>"));
        }
    }
    for (const std::string& xml : cases) {
        SCOPED_TRACE(xml);
        EXPECT_TRUE(holds(contracts::emitter_lanes(contracts::EmitterTrial(scene(xml)), {})));
    }
}

TEST_F(Emitters, EmissionStaysInsideTheBounds) {
    for (const std::string& xml :
         {shape("sphere", glow), shape("cube", glow + to_world("<rotate x='1' angle='20'/>")),
          shape("cylinder", glow), ball + emitter("point"),
          ball + emitter("spot", to_world("<lookat origin='1 2 3' target='0 0 1'/>")),
          ball + emitter("projector", to_world("<lookat origin='1 2 3' target='0 0 1'/>")),
          ball + emitter("spot", number("cutoff_angle", 120) + number("beam_width", 100))}) {
        SCOPED_TRACE(xml);
        EXPECT_TRUE(holds(contracts::emitter_bounds(contracts::EmitterTrial(scene(xml)), {})));
    }
}

TEST_F(Emitters, EmissionIsRadianceTimesCosine) {
    const Scene& s = scene(shape("cube", emitter("area", rgb("radiance", "1 2 3"))));
    Rng rng(8);
    for (int i = 0; i < 1000; ++i) {
        const Light& light = s.lights()[rng.next_uint() % s.lights().size()];
        const Vector2 u = rng.next_float2(), v = rng.next_float2();
        const auto e = light.emitter->sample_emission(light, u, v);
        const SurfaceSample at = light.shape->sample_area(light.primitive, u);
        const Color expected = Color(1, 2, 3) * glm::dot(at.n, e->ray.d);
        const Color carried = e->power * e->pdf_position * e->pdf_direction;
        EXPECT_LT(glm::distance(expected, carried), 1e-4f * glm::length(expected) + 1e-6f);
        EXPECT_FALSE(s.intersect(e->ray));  // it leaves, and does not hit what it starts on
    }
}

TEST_F(Emitters, LightFromInfinityFillsTheScene) {
    // A sphere of radius 1 receives π E from a direction, 4π² L from all around.
    const std::map<std::string, double> cases = {{emitter("directional"), pi_d},
                                                 {emitter("constant"), 4 * sqr(pi_d)}};
    for (const auto& [xml, received] : cases) {
        SCOPED_TRACE(xml);
        const Scene& s = scene(ball + xml);
        const Light& light = s.lights()[0];
        Rng rng(9);
        RunningStatistics power;
        for (int i = 0; i < 200000; ++i) {
            const Vector2 u = rng.next_float2(), v = rng.next_float2();
            const auto e = light.emitter->sample_emission(light, u, v);
            power.add(s.intersect(e->ray) ? static_cast<double>(e->power.x) : 0);
        }
        EXPECT_TRUE(equivalent(power, received, 0.015));
    }
}

TEST_F(Emitters, O4_PointLight) {
    const Scene& s = scene(
        ball + emitter("point", rgb("intensity", "10") + "<point name='position' value='1 0 2'/>"));
    EXPECT_NEAR(irradiance(s, receiver({0, 0, 0}, {0, 0, 1}), 10).mean(), 1.7888544, 1e-6);
    const Light& light = s.lights()[0];
    EXPECT_FALSE(light.emitter->sample_li(light, receiver({1, 0, 2}, {0, 0, 1}), {}));
    const Scene& moved = scene(
        ball + emitter("point", rgb("intensity", "10") + to_world("<translate x='1' z='2'/>")));
    EXPECT_NEAR(irradiance(moved, receiver({0, 0, 0}, {0, 0, 1}), 10).mean(), 1.7888544, 1e-6);
    EXPECT_NEAR(light.emitter->bounds(light).power, 40 * pi_d, 1e-4);
}

TEST_F(Emitters, O5_C17_DirectionalLight) {
    const auto cast = [&](const std::string& direction, Vector3 n) {
        const std::string body = fmt::format("<vector name='direction' value='{}'/>", direction);
        return irradiance(scene(ball + emitter("directional", body)), receiver({5, 5, 5}, n), 10)
            .mean();
    };
    EXPECT_NEAR(cast("0 -3 0", {0, 1, 0}), 1, 1e-6);
    EXPECT_NEAR(cast("0 -1 -1.7320508", {0, 1, 0}), 0.5, 1e-6);
    EXPECT_EQ(cast("1 0 0", {0, 1, 0}), 0);
    EXPECT_EQ(cast("0 1 0", {0, 1, 0}), 0);
    const Scene& turned =
        scene(ball + emitter("directional", to_world("<rotate x='1' angle='90'/>")));
    EXPECT_NEAR(irradiance(turned, receiver({0, 0, 0}, {0, 1, 0}), 10).mean(), 1, 1e-6);
    EXPECT_NE(refusal(emitter("directional", "<vector name='direction' value='0 0 0'/>")), "");
}

TEST_F(Emitters, C20_SpotPowers) {
    struct Cone {
        double cutoff, beam;
    };
    for (const auto [cutoff, beam] : {Cone{20, 15}, Cone{20, 20}, Cone{30, 0}, Cone{90, 45},
                                      Cone{180, 180}, Cone{180, 10}, Cone{1, 0.999}, Cone{0, 0}}) {
        SCOPED_TRACE(fmt::format("cutoff {} beam {}", cutoff, beam));
        const Scene& s =
            scene(ball + emitter("spot", rgb("intensity", "3") + number("cutoff_angle", cutoff) +
                                             number("beam_width", beam)));
        const Light& light = s.lights()[0];
        double flux = 0;
        constexpr int n = 100000;
        const double step = pi_d / n;
        for (int i = 0; i < n; ++i) {
            const double theta = (i + 0.5) * step;
            const Vector3 w(Vector3d(std::sin(theta), 0, std::cos(theta)));
            const auto li = light.emitter->sample_li(light, receiver(w, -w), {});
            if (!li) continue;
            flux += static_cast<double>(li->radiance.x) * std::sin(theta) * 2 * pi_d * step;
        }
        const double power = light.emitter->bounds(light).power;
        EXPECT_NEAR(power, flux, 1e-3 * flux + 1e-9);
        if (cutoff == beam) {
            EXPECT_NEAR(power, 6 * pi_d * (1 - std::cos(cutoff * pi_d / 180)), 1e-5 * power);
        }
    }
    EXPECT_NE(refusal(emitter("spot", number("beam_width", 21))), "");
    EXPECT_NE(refusal(emitter("spot", number("cutoff_angle", 181))), "");
}

TEST_F(Emitters, O18_SpotFallsLinearlyInTheAngle) {
    const Scene& s = scene(ball + emitter("spot"));
    const Light& light = s.lights()[0];
    const auto intensity = [&](double degrees) {
        const double a = degrees * pi_d / 180;
        const Vector3 w(Vector3d(0, std::sin(a), std::cos(a)));
        const auto li = light.emitter->sample_li(light, receiver(2.0f * w, -w), {});
        return li ? 4 * static_cast<double>(li->radiance.x) : 0;
    };
    EXPECT_NEAR(intensity(0), 1, 1e-6);
    EXPECT_NEAR(intensity(14.9), 1, 1e-6);
    EXPECT_NEAR(intensity(17.5), 0.5, 1e-5);
    EXPECT_NEAR(intensity(19), 0.2, 1e-5);
    EXPECT_EQ(intensity(20.1), 0);
    EXPECT_EQ(intensity(180), 0);
}

TEST_F(Emitters, SpotProjectsItsTexture) {
    const std::string picture = "<texture name='texture' type='bitmap'>" +
                                word("filename", "half.png") + word("filter_type", "nearest") +
                                "</texture>";
    const Scene& s = scene(ball + emitter("spot", picture));
    const Light& light = s.lights()[0];
    const auto lit = [&](float x) {
        const auto li = light.emitter->sample_li(light, receiver({x, 0, 5}, {0, 0, -1}), {});
        return li.has_value();
    };
    EXPECT_TRUE(lit(-0.5f));
    EXPECT_FALSE(lit(0.5f));
    EXPECT_NE(refusal(emitter("spot", picture + number("cutoff_angle", 100)), folder->path()), "");
}

TEST_F(Emitters, P4_SpotProjectsTheUpperLeftOfItsTextureToNegativeXAndY) {
    const Scene& s =
        scene(ball + emitter("spot", "<texture name='texture' type='bitmap'>" +
                                         word("filename", "upper_left.png") +
                                         word("filter_type", "nearest") + "</texture>"));
    const Light& light = s.lights()[0];
    for (const float x : {-0.5f, 0.5f}) {
        for (const float y : {-0.5f, 0.5f}) {
            const auto li = light.emitter->sample_li(light, receiver({x, y, 5}, {0, 0, -1}), {});
            EXPECT_EQ(li.has_value(), x < 0 && y < 0) << x << " " << y;
        }
    }
}

TEST_F(Emitters, ProjectorLightsAPlaneEvenly) {
    const std::string wide = "<texture name='irradiance' type='bitmap'>" +
                             word("filename", "half.png") + word("filter_type", "nearest") +
                             "</texture>" + number("scale", 2) + number("fov", 90);
    const Scene& s = scene(ball + emitter("projector", wide));
    const Light& light = s.lights()[0];
    // At z = 3 the picture is 6 wide and 3 high; its left half, at +x, is white.
    for (const auto& [x, y, inside] : {std::tuple{0.1f, 0.1f, true},
                                       {2.9f, 1.4f, true},
                                       {2.9f, -1.4f, true},
                                       {0.1f, 1.6f, false},
                                       {3.1f, 0.0f, false},
                                       {-0.1f, 0.0f, false},
                                       {-2.9f, 1.4f, false}}) {
        SCOPED_TRACE(fmt::format("{} {}", x, y));
        const auto li = light.emitter->sample_li(light, receiver({x, y, 3}, {0, 0, -1}), {});
        ASSERT_EQ(li.has_value(), inside);
        if (!inside) continue;
        EXPECT_NEAR(li->radiance.x * -li->wi.z, 2 * pi / 9, 1e-5f);
    }
    // Behind it is nothing; the flux is π scale · area · mean.
    EXPECT_FALSE(light.emitter->sample_li(light, receiver({1, 0, -3}, {0, 0, 1}), {}));
    EXPECT_NEAR(light.emitter->bounds(light).power, 2 * pi_d * 2 * 1 * 0.5, 1e-5);
    EXPECT_NE(refusal(emitter("projector", number("fov", 180))), "");
    EXPECT_NE(refusal(emitter("projector", number("fov", 30) + word("focal_length", "50mm"))), "");
}

TEST_F(Emitters, P4_ProjectorShowsItsPictureUpright) {
    const Scene& s =
        scene(ball +
              emitter("projector", number("fov", 90) + "<texture name='irradiance' type='bitmap'>" +
                                       word("filename", "upper_left.png") +
                                       word("filter_type", "nearest") + "</texture>"));
    const Light& light = s.lights()[0];
    for (const float x : {-0.5f, 0.5f}) {
        for (const float y : {-0.5f, 0.5f}) {
            const auto li = light.emitter->sample_li(light, receiver({x, y, 1}, {0, 0, -1}), {});
            EXPECT_EQ(li.has_value(), x > 0 && y > 0) << x << " " << y;
        }
    }
}

TEST_F(Emitters, O6_SquareLight) {
    const std::string square =
        to_world("<scale value='0.5'/>" + facing_down + "<translate z='1'/>");
    const Scene& s = scene(shape("rectangle", glow + square));
    const auto e = [&](Vector3 p, Vector3 n) { return irradiance(s, receiver(p, n)); };
    EXPECT_TRUE(equivalent(e({0, 0, 0}, {0, 0, 1}), 0.752274688, 0.005));
    EXPECT_TRUE(equivalent(e({0.75f, 0.3f, 0}, {0.3f, -0.2f, 1}), 0.301061350, 0.005));
    EXPECT_TRUE(equivalent(e({0, 0, 0}, {1, 0, 0.2f}), 0.176308422, 0.02));
}

TEST_F(Emitters, O8_DiskLight) {
    const Scene& s = scene(shape("disk", glow + to_world(facing_down + "<translate z='1'/>")));
    EXPECT_TRUE(equivalent(irradiance(s, receiver({0, 0, 0}, {0, 0, 1})), pi_d / 2, 0.01));
}

TEST_F(Emitters, O23_C2_InsideASphereOfLight) {
    const Scene& s = scene(shape("sphere", glow + "<boolean name='flip_normals' value='true'/>"));
    for (const Vector3 p : {Vector3(0), Vector3(0.5f, 0.2f, -0.1f), Vector3(0, 0, 0.6f)}) {
        EXPECT_TRUE(equivalent(irradiance(s, receiver(p, {1, 2, 3}), 400000), pi_d, 0.03));
    }
}

TEST_F(Emitters, C8_C19_TheBackAndThePlaneAreDark) {
    for (const char* type : {"rectangle", "disk"}) {
        const Scene& s = scene(shape(type, glow));
        for (const Vector3 p : {Vector3(0, 0, -1), Vector3(3, 0, 0), Vector3(0.2f, 0.1f, 0),
                                Vector3(1, 0, 0), Vector3(0.5f, 0, -1e-6f)}) {
            const RunningStatistics e = irradiance(s, receiver(p, {0, 0, 1}, Sides::both), 1000);
            EXPECT_EQ(e.mean(), 0);
        }
    }
}

TEST_F(Emitters, C18_HalfABlackSquareIsASmallerSquare) {
    const std::string half =
        emitter("area", "<texture name='radiance' type='bitmap'>" + word("filename", "half.png") +
                            word("filter_type", "nearest") + "</texture>");
    const std::string pose = facing_down + "<translate z='1'/>";
    const Scene& textured = scene(shape("rectangle", half + to_world(pose)));
    const Scene& moved =
        scene(shape("rectangle", glow + to_world("<scale x='0.5'/><translate x='-0.5'/>" + pose)));
    for (const Vector3 p : {Vector3(0), Vector3(0.6f, 0.3f, 0.2f), Vector3(-2, 1, -1)}) {
        const Receiver at = receiver(p, {0.1f, 0, 1});
        const RunningStatistics a = irradiance(textured, at, 400000);
        EXPECT_TRUE(equivalent(a, irradiance(moved, at, 400000).mean(), 0.02));
    }
    const double power = textured.lights()[0].emitter->bounds(textured.lights()[0]).power;
    EXPECT_NEAR(power, 2 * pi_d, 1e-4);
}

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
