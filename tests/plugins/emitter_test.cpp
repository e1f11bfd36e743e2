// SPDX-License-Identifier: Apache-2.0
/// What every emitter must satisfy, tried on all that the registry finds, and closed forms of the
/// light that each casts.
#include "plugins/commands/contracts/emitter.h"
#include "tests/plugins/emitters.h"

namespace lucerna {
namespace {

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

}  // namespace
}  // namespace lucerna
