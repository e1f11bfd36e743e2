// SPDX-License-Identifier: Apache-2.0
/// Light samplers where a camera looks at the scene, so that those that learn have learnt. What
/// holds at any point of any scene is tested in tests/hard_cases/light_sampler_test.cpp.
#include "core/interfaces/light_sampler.h"

#include "core/image/exr.h"
#include "core/interfaces/bsdf.h"
#include "plugins/commands/contracts/light_sampler.h"
#include "plugins/commands/contracts/light_scenes.h"
#include "plugins/light_samplers/learning/light_study.h"
#include "plugins/light_samplers/learning/pilot_paths.h"
#include "plugins/light_samplers/learning/region_study.h"
#include "plugins/light_samplers/lights/light_cut.h"
#include "tests/paths.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

namespace lucerna {
namespace {

class SeenLights : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, SeenLights, testing::ValuesIn(tested_samplers()),
                         [](const auto& type) { return type.param; });

using contracts::courtyard;

std::vector<Receiver> seen_points(const Scene& scene, std::uint32_t paths) {
    return pilot_receivers(scene, {.count = paths, .bounces = 1, .seed = 5}, Workers(1));
}

bool contributes(const Scene& scene, const Light& light, const Receiver& at) {
    return contracts::contributes(scene, light, at, true);
}

/// A sampler where a camera looks at a courtyard, tried at what is seen.
class InTheCourtyard {
public:
    InTheCourtyard(const std::string& type, std::uint32_t paths)
        : sampler_(tested_sampler(type), test_.scene()),
          points_(seen_points(test_.scene(), paths)) {}
    contracts::LightSamplerTrial trial() const {
        return {.sampler = *sampler_, .scene = test_.scene(), .points = points_, .blocked = true};
    }

private:
    TestScene test_{courtyard("")};
    PreparedSampler sampler_;
    std::vector<Receiver> points_;
};

TEST_P(SeenLights, E7_E8_E9_ProbabilitiesHoldAtPointsThatTheCameraSees) {
    const InTheCourtyard courtyard(GetParam(), 300);
    EXPECT_TRUE(holds(contracts::pmf_sums(courtyard.trial())));
    EXPECT_TRUE(holds(contracts::pmf_support(courtyard.trial())));
    EXPECT_TRUE(holds(contracts::pmf_of_draws(courtyard.trial())));
}

TEST_P(SeenLights, drawing_at_many_points_is_drawing_at_each) {
    EXPECT_TRUE(holds(contracts::draws_in_batches(InTheCourtyard(GetParam(), 300).trial(), {})));
}

TEST_P(SeenLights, E10_LightsAreDrawnAsOftenAsTheProbabilitySays) {
    const InTheCourtyard courtyard(GetParam(), 6);
    EXPECT_TRUE(holds(contracts::draw_frequencies(courtyard.trial(), {})));
    EXPECT_TRUE(holds(contracts::light_is_unbiased(courtyard.trial(), {})));
}

TEST_P(SeenLights, E15_CachePointsAreNeverMuchWorseThanTheTree) {
    // A light around the corner of the closest cache point is misjudged, but drawn nevertheless.
    if (!GetParam().starts_with("cache_")) GTEST_SKIP() << "not made from cache points";
    const TestScene test(courtyard(""));
    const Scene& scene = test.scene();
    const PreparedSampler prepared(tested_sampler(GetParam()), scene);
    const LightSampler& sampler = *prepared;
    const LightTree8 tree(scene);
    for (const Receiver& at : seen_points(scene, 300)) {
        const LightDistribution distribution = sampler.at(at);
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            EXPECT_GE(distribution.pmf(i), 0.099f * tree.pmf(ReceiverRegion(at), i));
        }
    }
}

/// Walls, a street and windows of a small city, from above.
std::string small_city(int lights) {
    const auto part = [&](const std::string& name, const std::string& content) {
        return fmt::format(
            "<shape type='city'><string name='part' value='{}'/><integer name='lights' "
            "value='{}'/>{}</shape>",
            name, lights, content);
    };
    return part("streets", diffuse(0.2)) + part("walls", diffuse(0.5)) +
           part("roofs", diffuse(0.3)) + part("windows", area_light(1)) +
           part("shops", area_light(1)) + part("lamps", area_light(400)) +
           "<sensor type='perspective'><float name='fov' value='45'/><transform name='to_world'>"
           "<lookat origin='-120,60,160' target='0,20,0' up='0,1,0'/></transform>"
           "<film type='hdrfilm'><integer name='width' value='320'/>"
           "<integer name='height' value='180'/></film></sensor>";
}

TEST(LightLanes, AreZeroOnlyWhereNothingCanArrive) {
    // A cluster over the origin, or below it, whose lights look up or down, within 25 degrees.
    const auto at_origin = [](float height, float up, bool two_sided, Sides sides) {
        const Vector3 half(0.2f, 0.1f, 0.1f), middle(0.3f, 0, height);
        const LightCluster cluster{.box = {middle - half, middle + half},
                                   .axis = {0, 0, up},
                                   .cos_normals = 0.9f,
                                   .cos_emission = 0,
                                   .power = 1,
                                   .two_sided = two_sided};
        LightLanes lanes;
        set_lane(lanes, 3, cluster);
        float result[LightLanes::width];
        contributions(lanes,
                      ReceiverRegion(Receiver{.n = {0, 0, 1}, .ns = {0, 0, 1}, .sides = sides}),
                      result);
        return result[3];
    };
    for (const bool two_sided : {false, true}) {
        EXPECT_GT(at_origin(2, -1, two_sided, Sides::front), 0);
        EXPECT_EQ(at_origin(-2, 1, two_sided, Sides::front), 0);
        EXPECT_GT(at_origin(-2, 1, two_sided, Sides::back), 0);
        EXPECT_GT(at_origin(-2, 1, two_sided, Sides::both), 0);
        // Across the horizon
        EXPECT_GT(at_origin(-0.05f, 1, two_sided, Sides::front), 0);
    }
    EXPECT_EQ(at_origin(2, 1, false, Sides::both), 0);
    EXPECT_GT(at_origin(2, 1, true, Sides::both), 0);
}

TEST(CacheSampler, E15_WallsUnderHundredsOfDimWindowsKnowThem) {
    // Lamps below outshine the windows across the street in the bounds of any cluster; they are
    // not seen from high walls, and what is left must not be drawn by such bounds.
    constexpr int lights = 3000;
    const TestScene test(small_city(lights));
    const Scene& scene = test.scene();
    const PreparedSampler cache(light_sampler("cache"), scene);
    const PreparedSampler exhaustive(light_sampler("exhaustive"), scene);
    // Of one draw, if all that the lights in sight contribute is what geometry tells.
    std::vector<double> found;
    for (const Receiver& at :
         pilot_receivers(scene, {.count = 100, .bounces = 0, .seed = 5}, Workers(1))) {
        double second_moment = 0, sum = 0;
        const LightDistribution cached = cache->at(at), weighed = exhaustive->at(at);
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            const auto u = static_cast<double>(weighed.pmf(i));
            if (!(u > 0) || !contributes(scene, scene.lights()[i], at)) continue;
            second_moment += u * u / static_cast<double>(cached.pmf(i));
            sum += u;
        }
        if (sum > 0) found.push_back(second_moment / (sum * sum));
    }
    std::sort(found.begin(), found.end());
    ASSERT_GT(found.size(), 40u);
    EXPECT_LT(found[found.size() / 2], 2);
    EXPECT_LT(found[found.size() * 9 / 10], 5);
}

/// Samplers that divide a light tree, with parameters by which they divide all of it.
class CutSamplers : public testing::TestWithParam<std::pair<const char*, const char*>> {
protected:
    static std::string sampler(double limit, int parts) {
        const auto [type, name] = GetParam();
        return light_sampler(type, number(name, limit) + integer("parts", parts));
    }
};

INSTANTIATE_TEST_SUITE_P(All, CutSamplers,
                         testing::Values(std::pair("adaptive_tree", "splitting_threshold"),
                                         std::pair("slc", "error")));

TEST_P(CutSamplers, trees_that_are_divided_to_the_end_draw_each_light_alike) {
    // Over a floor, no more than parts.
    std::string content = shape("rectangle", scale(3), diffuse(0.5)) +
                          xml({.to_world = look({0, -4, 4}, {0, 0, 0}), .fov = 50});
    for (int i = 0; i < 50; ++i) {
        content +=
            point_light({-2 + 0.7 * (i % 7), -2 + 0.6 * (i / 7), 0.5 + 0.1 * (i % 5)}, 1 + i);
    }
    const TestScene test(content);
    const Scene& scene = test.scene();
    const bool adaptive = std::string(GetParam().first) == "adaptive_tree";
    const PreparedSampler prepared(sampler(adaptive ? 1 : 0, 64), scene);
    int contributing = 0;
    for (const Receiver& at : seen_points(scene, 100)) {
        const LightDistribution lights = prepared->at(at);
        float each = 0;
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            each = std::max(each, lights.pmf(i));
        }
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            EXPECT_TRUE(lights.pmf(i) == 0 || lights.pmf(i) == each) << lights.pmf(i);
            if (!contributes(scene, scene.lights()[i], at)) continue;
            EXPECT_EQ(lights.pmf(i), each) << "light " << i;
            ++contributing;
        }
    }
    EXPECT_GT(contributing, 1000);
}

TEST(LightCut, coarse_cuts_have_fewer_parts) {
    const TestScene test(courtyard(""));
    const LightBVH tree(test.scene());
    const auto parts = [&](const Receiver& at, float tolerance) {
        const auto judge = [&](std::uint32_t node) {
            return CutNode{node, contribution(tree, node, at),
                           tree[node].leaf ? 0 : largest_contribution(tree, node, at)};
        };
        std::uint32_t nodes[16];
        return cut_tree(tree, 16, tolerance, judge, nodes);
    };
    std::size_t coarse = 0, fine = 0;
    for (const Receiver& at : seen_points(test.scene(), 100)) {
        coarse += parts(at, 1e30f);
        fine += parts(at, 0.1f);
    }
    EXPECT_GT(fine, 2 * coarse);
}

TEST(RegionStudy, posteriors_of_the_second_moment) {
    Observations none;
    EXPECT_DOUBLE_EQ(none.root_mean_square(3), 1);
    // One ray that brings 1: p = 3/4, and of the brought light the mean is 1, the variance 1/2.
    Observations one;
    one.add(2);
    EXPECT_DOUBLE_EQ(one.root_mean_square(0.5), std::sqrt(0.75 * 1.5));
    // Many rays say what they are: a quarter is hidden, others bring 1 or 3.
    Observations many;
    for (int i = 0; i < 4000000; ++i) many.add(i % 4 == 0 ? 0 : i % 4 == 1 ? 3 : 1);
    EXPECT_NEAR(many.root_mean_square(1), std::sqrt(11.0 / 4), 1e-5);
    // Hidden ones are never forgotten.
    Observations hidden;
    for (int i = 0; i < 99; ++i) hidden.add(0);
    EXPECT_DOUBLE_EQ(hidden.root_mean_square(1), std::sqrt(0.005 * 2));
}

TEST(LearnedSampler, draws_more_lights_that_are_seen_the_more_rays_it_learns_from) {
    const TestScene test(courtyard("", 256));
    const Scene& scene = test.scene();
    // The share of draws for lights that are seen, from points that have light.
    const auto seen = [&](const std::string& element) {
        const PreparedSampler sampler(element, scene);
        double sum = 0, all = 0;
        for (const Receiver& at : seen_points(scene, 200)) {
            double lit = 0, drawn = 0;
            const LightDistribution lights = sampler->at(at);
            for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
                if (scene.lights()[i].emitter->infinite()) continue;
                const auto p = static_cast<double>(lights.pmf(i));
                drawn += p;
                if (contributes(scene, scene.lights()[i], at)) lit += p;
            }
            if (lit > 0) sum += lit / drawn, all += 1;
        }
        return sum / all;
    };
    double before = 0;
    for (const int rays : {0, 2, 16}) {
        const double now = seen(light_sampler("learned", integer("rays_per_cluster", rays)));
        EXPECT_GT(now, before) << rays;
        before = now;
    }
}

std::string direct_hidden(const std::string& content) {
    return direct_integrator(content + boolean("hide_emitters", true));
}
std::string direct_with(const std::string& sampler) {
    return direct_hidden(tested_sampler(sampler));
}

TEST_P(SeenLights, MeanIsThatOfAllLights) {
    static const std::string all = with_all_lights(direct_hidden, courtyard("", 8));
    static const RunningStatistics reference = image_means(courtyard(all, 8), 64, 8);
    const RunningStatistics means = image_means(courtyard(direct_with(GetParam()), 8), 2560, 8);
    EXPECT_TRUE(agree(means, reference, 0.01));
}

TEST_P(SeenLights, ThreadsDoNotChangeTheImage) {
    const std::string text = courtyard(path_integrator(tested_sampler(GetParam())), 8);
    const TestScene one(text), again(text);
    const std::vector<double> expected = numbers_of(one.render({.per_pixel = 2, .threads = 1}));
    EXPECT_EQ(numbers_of(again.render({.per_pixel = 2, .threads = 3})), expected);
}

/// A room with a window under an environment map of many patches, and two lamps.
class SkyBehindAWindow : public testing::TestWithParam<std::string> {
protected:
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        write_sky([](int x, int y) {
            return Color(x == 70 && y == 20 ? 300.0f : y < 32 ? 1.0f : 0.2f, 0.5f, 0.3f);
        });
    }
    static void TearDownTestSuite() { delete folder; }

    static void write_sky(const std::function<Color(int, int)>& color) {
        Image image(128, 64);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) image.set_rgb(x, y, color(x, y));
        }
        ImageFile file;
        add_layer(file, image);
        write_exr(*folder / "sky.exr", file);
    }
    static std::string sky() {
        return "<emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>";
    }
    static std::string room(const std::string& integrator, int width = 16) {
        const std::string wall = diffuse(0.5);
        return integrator + sky() +
               xml({.to_world = look({0.5, -0.5, 0.8}, {-1, 1, -0.5}),
                    .fov = 80,
                    .width = width,
                    .height = width,
                    .sampler = "sobol"}) +
               shape("rectangle", translate({0, 0, -1}), wall) +
               shape("rectangle", look({0, 0, 1}, {0, 0, 0}), wall) +
               shape("rectangle", look({-1, 0, 0}, {0, 0, 0}), wall) +
               shape("rectangle", look({0, 1, 0}, {0, 0, 0}), wall) +
               shape("rectangle", look({0, -1, 0}, {0, 0, 0}), wall) +
               shape("rectangle", scale(0.6) + look({1, 0, -0.4}, {0, 0, -0.4}), wall) +
               sphere({0, 0, -0.5}, 0.3, wall) + point_light({0.5, 0.5, 0.5}, 0.1) +
               sphere({-0.5, -0.5, 0.5}, 0.05, area_light(5));
    }

    static inline TemporaryFolder* folder = nullptr;
};

INSTANTIATE_TEST_SUITE_P(All, SkyBehindAWindow, testing::ValuesIn(tested_samplers()),
                         [](const auto& type) { return type.param; });

TEST_P(SkyBehindAWindow, ProbabilitiesAreThoseOfTheDraws) {
    const TestScene test(room("", 64), folder->path());
    const Scene& scene = test.scene();
    ASSERT_GT(scene.lights().size(), 50u);
    const PreparedSampler prepared(tested_sampler(GetParam()), scene);
    const LightSampler& sampler = *prepared;
    int checked = 0;
    for (const Receiver& at : seen_points(scene, 100)) {
        const LightDistribution distribution = sampler.at(at);
        double sum = 0;
        for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
            const float p = distribution.pmf(i);
            sum += static_cast<double>(p);
            if (!contributes(scene, scene.lights()[i], at)) continue;
            EXPECT_GT(p, 0) << "light " << i;
            ++checked;
        }
        EXPECT_LE(sum, 1 + 1e-5);
        std::vector<double> drawn(scene.lights().size());
        constexpr int trials = 4096;
        for (int k = 0; k < trials; ++k) {
            const auto choice = distribution.sample((k + 0.5) / trials);
            if (!choice) continue;
            EXPECT_EQ(choice->pmf, distribution.pmf(choice->light));
            ++drawn[choice->light];
        }
        if (GetParam() == "ris") continue;  // whose pmf is not the probability
        for (std::uint32_t i = 0; i < drawn.size(); ++i) {
            EXPECT_NEAR(drawn[i] / trials, static_cast<double>(distribution.pmf(i)), 4e-3);
        }
    }
    EXPECT_GT(checked, 1000);
}

/// One test for all samplers: its reference takes most of the time.
TEST_F(SkyBehindAWindow, MeanIsThatOfAllLights) {
    const auto mean = [&](const std::string& integrator, std::uint64_t samples) {
        const TestScene scene(room(integrator), folder->path());
        return pixel_statistics(scene.render({.per_pixel = samples})).mean();
    };
    const double reference = mean(with_all_lights(direct_hidden, room(""), folder->path()), 128);
    for (const std::string& sampler : tested_samplers()) {
        EXPECT_NEAR(mean(direct_with(sampler), 2048), reference, 0.01 * reference) << sampler;
    }
}

TEST_P(SkyBehindAWindow, ThreadsDoNotChangeTheImage) {
    const std::string text = room(path_integrator(tested_sampler(GetParam())), 48);
    const TestScene one(text, folder->path()), again(text, folder->path());
    const std::vector<double> expected = numbers_of(one.render({.per_pixel = 2, .threads = 1}));
    EXPECT_EQ(numbers_of(again.render({.per_pixel = 2, .threads = 3})), expected);
}

TEST_F(SkyBehindAWindow, CacheLearnsWhatTheWindowShows) {
    const TestScene test(room("", 256), folder->path());
    const Scene& scene = test.scene();
    // The share of draws of the sky that arrive at points that the camera sees.
    const auto arriving = [&](const std::string& type) {
        const PreparedSampler sampler(light_sampler(type), scene);
        Rng rng(4);
        RunningStatistics seen;
        for (const Receiver& at : seen_points(scene, 2000)) {
            const double u = rng.next_double();
            const Vector2 u_light = rng.next_float2();
            const auto choice = sampler->at(at).sample(u);
            if (!choice || !scene.lights()[choice->light].emitter->infinite()) continue;
            const Light& light = scene.lights()[choice->light];
            const auto li = light.emitter->sample_li(light, at, u_light);
            seen.add(li && glm::dot(li->wi, at.n) > 0 && !scene.occluded(at, *li) ? 1 : 0);
        }
        return seen.mean();
    };
    EXPECT_GT(arriving("cache"), 2.5 * arriving("power"));
}

/// A white environment lights a surface of albedo 1 so that it cannot be told from it.
TEST_F(SkyBehindAWindow, O17_WhiteFurnaceOfAPicture) {
    write_sky([](int, int) { return Color(1); });
    for (const std::string& sampler : tested_samplers()) {
        SCOPED_TRACE(sampler);
        const TestScene test(path_integrator(tested_sampler(sampler)) + sky() +
                                 xml({.to_world = look({0, -5, 1}, {0, 0, 0}),
                                      .fov = 20,
                                      .width = 16,
                                      .height = 16,
                                      .sampler = "sobol"}) +
                                 sphere({0, 0, 0}, 1, diffuse(1)),
                             folder->path());
        ASSERT_GT(test.scene().lights().size(), 50u);
        EXPECT_TRUE(agrees(pixel_statistics(test.render({.per_pixel = 512})), 1, 0.005));
    }
}

}  // namespace
}  // namespace lucerna
