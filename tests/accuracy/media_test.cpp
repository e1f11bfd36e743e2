// SPDX-License-Identifier: Apache-2.0
/// Renders of participating media against closed forms: what is absorbed, what is scattered once,
/// and furnaces in which nothing can be seen.
#include "tests/paths.h"
#include "tests/render_scene.h"
#include "tests/vol_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

using std::numbers::pi;

std::string volpath(const std::string& inside = "") {
    return "<integrator type='volpath'>" + inside + "</integrator>";
}
std::string rgb(const std::string& name, Vector3d v) {
    return fmt::format("<rgb name='{}' value='{}'/>", name, text_of(v));
}
std::string hg(double g) { return "<phase type='hg'>" + number("g", g) + "</phase>"; }
std::string fog(const std::string& name, const std::string& inside) {
    return fmt::format("<medium type='homogeneous' name='{}'>{}</medium>", name, inside);
}
const double near_clip = TestCamera().near_clip;  // where rays start
const std::string null_surface = "<bsdf type='null'/>";
std::string glass(double ior) {
    return "<bsdf type='dielectric'>" + number("int_ior", ior) + number("ext_ior", 1) + "</bsdf>";
}
/// From z = 0 to z = `depth`.
std::string slab(double depth, const std::string& inside) {
    return shape(
        "cube",
        fmt::format("<scale x='2' y='2' z='{}'/>", depth / 2) + translate({0, 0, depth / 2}),
        inside);
}
/// Looks along the normal of the slabs.
TestCamera along_z() { return {.to_world = look({0, 0, -1}, {0, 0, 0}), .width = 4, .height = 4}; }

double one_channel(const FilmState& film, std::size_t channel, double tolerance = 1e-5) {
    const Interval range = pixel_range(film, channel);
    EXPECT_NEAR(range.low, range.high, tolerance * range.high);
    return 0.5 * (range.low + range.high);
}

/// A medium that only absorbs is not sampled: renders have no noise at all.
TEST(AbsorbingSlab, O12_BeersLawInEachChannel) {
    const Vector3d sigma(0.1, 1, 4);
    for (const std::string& given :
         {rgb("albedo", Vector3d(0)) + rgb("sigma_t", sigma), rgb("sigma_a", sigma),
          rgb("sigma_a", 0.5 * sigma) + number("scale", 2)}) {
        const std::string medium = fog("interior", given);
        // With and without a BSDF that says that there is no surface.
        for (const std::string& surface : {null_surface, std::string()}) {
            const FilmState film = TestScene(volpath() + constant_light(1) + xml(along_z()) +
                                             slab(1.5, surface + medium))
                                       .render({.per_pixel = 4});
            for (int c = 0; c < 3; ++c) {
                const double expected = std::exp(-1.5 * sigma[c]);
                // Rays start off their surface by the rounding of its coordinates.
                EXPECT_NEAR(one_channel(film, static_cast<std::size_t>(c)), expected,
                            2e-5 * expected);
            }
        }
    }
}

/// Glass that absorbs, with all reflections between its faces.
TEST(AbsorbingSlab, O12_AGlassSlabWithColour) {
    const Vector3d sigma(0.1, 1, 3);
    const TestScene scene(volpath(integer("rr_depth", 1000)) + constant_light(1) + xml(along_z()) +
                          slab(0.7, glass(1.5) + fog("interior", rgb("sigma_a", sigma))));
    const double f = 0.04;
    for (int c = 0; c < 3; ++c) {
        const double t = std::exp(-0.7 * sigma[c]);
        const double expected = f + f * (1 - f) * (1 - f) * t * t / (1 - f * f * t * t) +
                                (1 - f) * (1 - f) * t / (1 - f * f * t * t);
        RunningStatistics means;
        for (std::uint64_t seed = 0; seed < 12; ++seed) {
            const FilmState film = scene.render({.per_pixel = 1024, .seed = seed});
            means.add(pixel_statistics(film, static_cast<std::size_t>(c)).mean());
        }
        EXPECT_TRUE(agrees(means, expected, 0.006)) << c;
    }
}

/// Behind surfaces, the side of the normal says in which medium light goes on: touching, nested,
/// and with normals that are turned inwards.
TEST(MediumInterfaces, TheGeometricNormalChooses) {
    const std::string thin = rgb("sigma_a", Vector3d(0.5)), thick = rgb("sigma_a", Vector3d(2));
    const auto expect = [](const std::string& shapes, double depth, const std::string& camera) {
        const FilmState film =
            TestScene(volpath() + constant_light(1) + shapes + camera).render({.per_pixel = 1});
        EXPECT_TRUE(is_constant(film, std::exp(-depth))) << shapes;
    };
    const std::string outside = xml(along_z());
    // One cube in another; the inner one names the medium around it.
    expect(sphere({0, 0, 3}, 2, null_surface + fog("interior", thin)) +
               sphere({0, 0, 3}, 1, null_surface + fog("interior", thick) + fog("exterior", thin)),
           2 * 0.5 + 2 * 2, outside);
    // Normals that are turned swap the sides.
    expect(
        sphere({0, 0, 3}, 2, null_surface + boolean("flip_normals", true) + fog("exterior", thin)),
        4 * 0.5, outside);
    // Touching: a sheet in between leads from the one into the other.
    const auto sheet = [&](double z, const std::string& media) {
        return shape("rectangle", scale(2) + translate({0, 0, z}), null_surface + media);
    };
    expect(sheet(0, fog("exterior", thin)) +
               sheet(1, fog("interior", thin) + fog("exterior", thick)) +
               sheet(2, fog("interior", thick)),
           0.5 + 2, outside);
    // The camera lies in the medium, and says so.
    TestCamera inside{.to_world = look({0, 0, 3}, {0, 0, 9}), .width = 2, .height = 2};
    inside.inside = fog("", thick);
    expect(sphere({0, 0, 3}, 2, null_surface + fog("interior", thick)), 2 * (2 - near_clip),
           xml(inside));
}

/// Light of a lamp and of the sky through boundaries, both by light sampling and by chance.
TEST(AbsorbingSlab, G8_ShadowRaysAndPathsMeetTheSameMedium) {
    const std::string floor =
        shape("rectangle", scale(1e-3), diffuse(0.5)) +
        xml({.to_world = look({0.2, 0, 0.3}, {0, 0, 0}), .width = 4, .height = 4});
    const std::string veil = shape("cube", "<scale x='9' y='9' z='0.1'/>" + translate({0, 0, 1}),
                                   null_surface + fog("interior", rgb("sigma_a", Vector3d(3))));
    const FilmState film = TestScene(volpath() + floor + veil + point_light({0, 0, 2}, 4 * pi))
                               .render({.per_pixel = 4});
    EXPECT_TRUE(is_constant(film, 0.5 * std::exp(-0.6), 1e-4));
    // A small lamp above, which both strategies find.
    const std::string lamp =
        shape("rectangle", scale(0.5) + look({0, 0, 1.5}, {0, 0, 0}), diffuse(0) + area_light(1));
    const RunningStatistics all = image_means(volpath() + floor + veil + lamp, 512);
    const RunningStatistics few =
        image_means(volpath(integer("max_depth", 2)) + floor + veil + lamp, 512);
    EXPECT_TRUE(agree(all, few, 0.005));
}

/// ∫ σs exp(−σt t) f(cos θ) I / d² exp(−σt d) dt along the x axis, from the near clip plane on,
/// with a light at (at, h).
double single_scattering(double sigma_s, double sigma_t, double g, double at, double h) {
    const auto integrand = [&](double t) {
        const double x = at - t, d = std::hypot(x, h), cosine = -x / d;  // towards the camera
        const double base = 1 + g * g + 2 * g * cosine;
        const double f = (1 - g * g) / (4 * pi * base * std::sqrt(base));
        return sigma_s * f * std::exp(-sigma_t * (t - near_clip + d)) / (d * d);
    };
    const int n = 200000;
    const double end = at + 40 / sigma_t, step = end / n;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += integrand(near_clip + (i + 0.5) * step) * step;
    return sum;
}

TEST(SingleScattering, APointLightInAnInfiniteMedium) {
    for (const double g : {0.0, 0.7, -0.5}) {
        for (const double sigma_t : {0.3, 2.0}) {
            TestCamera camera{.to_world = look({0, 0, 0}, {1, 0, 0})};
            camera.inside = fog("", number("sigma_t", sigma_t) + number("albedo", 0.6) + hg(g));
            const double expected = single_scattering(0.6 * sigma_t, sigma_t, g, 2, 0.7);
            EXPECT_TRUE(agrees(image_means(volpath(integer("max_depth", 2)) + xml(camera) +
                                               point_light({2, 0.7, 0}, 1),
                                           256),
                               expected, 0.005))
                << g << ' ' << sigma_t;
        }
    }
}

/// Channels whose extinction differs by a factor of 30 are estimated together.
TEST(SingleScattering, ColouredExtinction) {
    const Vector3d sigma(0.1, 0.7, 3);
    TestCamera camera{.to_world = look({0, 0, 0}, {1, 0, 0})};
    camera.inside = fog("", rgb("sigma_t", sigma) + number("albedo", 1));
    const TestScene scene(volpath(integer("max_depth", 2)) + xml(camera) +
                          point_light({2, 0.7, 0}, 1));
    RunningStatistics means[3];
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const FilmState film = scene.render({.per_pixel = 256, .seed = seed});
        for (std::size_t c = 0; c < 3; ++c) means[c].add(pixel_statistics(film, c).mean());
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(agrees(means[c], single_scattering(sigma[c], sigma[c], 0, 2, 0.7), 0.01)) << c;
    }
}

/// Nothing is absorbed, so nothing can be told from its surroundings of radiance 1.
TEST(WhiteFurnace, O13_MediaThatOnlyScatter) {
    const auto white = [](double sigma_t, double g) {
        return number("albedo", 1) + number("sigma_t", sigma_t) + hg(g);
    };
    const std::string rest =
        volpath(integer("rr_depth", 100)) + constant_light(1) +
        xml({.to_world = look({0, 0, -3}, {0.2, 0.1, 0}), .width = 4, .height = 4});
    const auto ball = [](double radius, const std::string& inside) {
        return sphere({0, 0, 0}, radius, inside);
    };
    const std::vector<std::string> scenes = {
        ball(1, null_surface + fog("interior", white(2, 0))),
        ball(1, null_surface + fog("interior", white(5, 0.8))),
        ball(1, null_surface +
                    fog("interior", number("albedo", 1) + rgb("sigma_t", Vector3d(0.2, 1, 5)))),
        ball(1, glass(1.5) + fog("interior", white(2, 0.3))),
        ball(1, null_surface + fog("interior", white(1, 0))) +
            ball(0.5, glass(1.3) + fog("interior", white(6, -0.4)) + fog("exterior", white(1, 0))),
    };
    for (const std::string& scene : scenes) {
        EXPECT_TRUE(agrees(image_means(rest + scene, 256), 1, 0.006)) << scene;
    }
}

/// Walls that emit what they absorb: light samples and directions that meet the walls by chance are
/// weighted against each other, at walls, at collisions and along rays.
TEST(WhiteFurnace, O13_AnyNumberOfLightSamples) {
    const std::string white = number("albedo", 1) + number("sigma_t", 0.8) + hg(0.4);
    TestCamera camera{.to_world = look({0, 0.2, -0.5}, {0.2, 0.1, 0}), .width = 4, .height = 4};
    camera.inside = fog("", white);
    const std::string scene = shape("cube", "",
                                    boolean("flip_normals", true) + diffuse(0.5) + area_light(0.5) +
                                        fog("exterior", white)) +
                              xml(camera);
    for (const int passes : {1, 3}) {
        const std::string integrator = volpath(integer("emitter_samples", passes));
        EXPECT_TRUE(agrees(image_means(integrator + scene, 160), 1, 0.006)) << passes;
    }
}

/// Chandrasekhar's H of isotropic scattering (1950, "Radiative Transfer", 37), by iteration of
/// 1 / H(μ) = √(1 − ϖ) + ϖ/2 ∫ μ' H(μ') / (μ + μ') dμ'.
double chandrasekhar_h(double albedo, double mu) {
    constexpr int n = 400;
    const auto node = [](int i) { return (i + 0.5) / n; };
    std::vector<double> h(n, 1.0);
    const auto inverse_h = [&](double m) {
        double sum = 0;
        for (int i = 0; i < n; ++i) sum += node(i) * h[static_cast<std::size_t>(i)] / (m + node(i));
        return std::sqrt(1 - albedo) + 0.5 * albedo * sum / n;
    };
    for (int iteration = 0; iteration < 200; ++iteration) {
        std::vector<double> next;
        for (int i = 0; i < n; ++i) next.push_back(1 / inverse_h(node(i)));
        h = std::move(next);
    }
    return 1 / inverse_h(mu);
}

/// Under a sky of radiance 1, a half-space returns 1 − √(1 − ϖ) H(μ).
TEST(HalfSpace, ReflectsWhatChandrasekharSays) {
    for (const double albedo : {0.4, 0.9}) {
        for (const double mu : {1.0, 0.5}) {
            const double sine = std::sqrt(1 - mu * mu);
            TestCamera camera{
                .to_world = look({-sine, 0, -mu}, {0, 0, 0}), .width = 4, .height = 4};
            const std::string medium =
                fog("interior", number("albedo", albedo) + number("sigma_t", 30));
            const std::string ground =
                shape("cube", scale(20) + translate({0, 0, 20}), null_surface + medium);
            EXPECT_TRUE(
                agrees(image_means(volpath() + constant_light(1) + xml(camera) + ground, 512),
                       1 - std::sqrt(1 - albedo) * chandrasekhar_h(albedo, mu), 0.006))
                << albedo << ' ' << mu;
        }
    }
}

/// Emission along a way of length s in an absorbing medium: ε (1 − exp(−σ s)) / σ.
TEST(EmittingMedium, AHomogeneousSlab) {
    const Vector3d sigma(0, 1, 4), emission(0.3, 1, 2);
    const FilmState film =
        TestScene(volpath() + xml(along_z()) +
                  slab(1.5, null_surface +
                                fog("interior", rgb("sigma_a", sigma) + rgb("emission", emission))))
            .render({.per_pixel = 2});
    for (int c = 0; c < 3; ++c) {
        const double way = c == 0 ? 1.5 : (1 - std::exp(-1.5 * sigma[c])) / sigma[c];
        EXPECT_NEAR(one_channel(film, static_cast<std::size_t>(c)), emission[c] * way,
                    2e-5 * emission[c] * way);
    }
}

/// Oriented flakes, S = (0.15, 1, 0.8, 0.05, 0.1, −0.2): extinction is density · σ(ω).
class OrientedFlakes : public testing::Test {
protected:
    static double form(Vector3d a, Vector3d b) {
        const glm::dmat3 s({0.15, 0.05, 0.1}, {0.05, 1, -0.2}, {0.1, -0.2, 0.8});
        return glm::dot(a, s * b);
    }
    static double area(Vector3d w) { return std::sqrt(form(w, w)); }
    /// σ(wo) f(wo, wi) = D(h) / 4
    static double scattered(Vector3d wo, Vector3d wi) {
        const glm::dmat3 s({0.15, 0.05, 0.1}, {0.05, 1, -0.2}, {0.1, -0.2, 0.8});
        const Vector3d h = glm::normalize(wo + wi);
        const double square = glm::dot(h, glm::inverse(s) * h);
        return 1 / (4 * pi * std::sqrt(glm::determinant(s)) * square * square);
    }
    static constexpr const char* flakes =
        "<phase type='sggx'><string name='S' value='0.15, 1, 0.8, 0.05, 0.1, -0.2'/></phase>";

    /// The same medium three times: homogeneous, tracked below majorants, and with S from a grid.
    std::vector<std::string> media(const std::string& name, double density, double albedo) const {
        write_bytes(folder_ / "one.vol",
                    vol_bytes({.resolution = {2, 2, 2}}, std::vector<float>(8, 1.0f)));
        std::vector<float> matrices;
        for (int i = 0; i < 8; ++i) {
            for (const float x : {0.15f, 1.0f, 0.8f, 0.05f, 0.1f, -0.2f}) matrices.push_back(x);
        }
        write_bytes(folder_ / "s.vol",
                    vol_bytes({.resolution = {2, 2, 2}, .channels = 6}, matrices));
        const std::string numbers = number("albedo", albedo) + number("scale", density);
        const std::string grid =
            "<volume type='gridvolume' name='{}'><string name='filename' "
            "value='{}'/><transform name='to_world'><scale value='8'/>"
            "<translate x='-4' y='-4' z='-4'/></transform></volume>";
        const auto medium = [&](const std::string& inside) {
            return fmt::format("<medium type='heterogeneous' name='{}'>{}</medium>", name,
                               numbers + inside);
        };
        const std::string tracked =
            fmt::format(fmt::runtime(grid), "sigma_t", (folder_ / "one.vol").string());
        return {fog(name, numbers + flakes), medium(tracked + flakes),
                medium(tracked + "<phase type='sggx'>" +
                       fmt::format(fmt::runtime(grid), "S", (folder_ / "s.vol").string()) +
                       "</phase>")};
    }

private:
    TemporaryFolder folder_;
};

TEST_F(OrientedFlakes, G15_O12_BeersLawDependsOnTheDirection) {
    for (const Vector3d from : {Vector3d(0, 0, -3), Vector3d(1, -0.5, -2), Vector3d(-1, 1, -2)}) {
        const Vector3d w = glm::normalize(from);
        const double way = 1.2 / std::abs(w.z);
        const double expected = std::exp(-1.5 * area(w) * way);
        for (const std::string& medium : media("interior", 1.5, 0)) {
            const std::string scene =
                volpath() + constant_light(1) + slab(1.2, null_surface + medium) +
                xml({.to_world = look(from, {0, 0, 0}), .width = 4, .height = 4});
            EXPECT_TRUE(agrees(image_means(scene, 2048), expected, 0.008)) << medium;
        }
    }
}

TEST_F(OrientedFlakes, G15_ShadowRaysMeetTheirOwnDirection) {
    // A point light at (2, 0.7, 0.4), seen along the x axis in an infinite medium.
    const double density = 0.9, albedo = 0.6;
    const Vector3d light(2, 0.7, 0.4), d(1, 0, 0);
    double expected = 0;
    constexpr int n = 200000;
    constexpr double end = 4, step = end / n;
    for (int i = 0; i < n; ++i) {
        const double t = near_clip + (i + 0.5) * step;
        const Vector3d to = light - t * d, w = glm::normalize(to);
        const double thickness = area(d) * (t - near_clip) + area(w) * glm::length(to);
        expected += density * albedo * scattered(-d, w) * std::exp(-density * thickness) /
                    glm::dot(to, to) * step;
    }
    const std::string wall =
        shape("rectangle", scale(9) + look({end + near_clip, 0, 0}, {0, 0, 0}), diffuse(0));
    for (const std::string& medium : media("", density, albedo)) {
        TestCamera camera{.to_world = look({0, 0, 0}, d)};
        camera.inside = medium;
        const std::string scene =
            volpath(integer("max_depth", 2)) + xml(camera) + wall + point_light(light, 1);
        EXPECT_TRUE(agrees(image_means(scene, 1024), expected, 0.01)) << medium;
    }
}

TEST_F(OrientedFlakes, G15_O13_WhiteFlakesAreNotSeenInAFurnace) {
    for (const std::string& medium : media("interior", 3, 1)) {
        const std::string scene =
            volpath(integer("rr_depth", 100)) + constant_light(1) +
            sphere({0, 0, 0}, 1, null_surface + medium) +
            xml({.to_world = look({0, 0, -3}, {0.2, 0.1, 0}), .width = 4, .height = 4});
        EXPECT_TRUE(agrees(image_means(scene, 256), 1, 0.006)) << medium;
    }
}

/// Particles meet flakes along other directions than paths from the camera, and both find the same
/// light: photons are scattered by f(w, ·) of their own direction.
TEST_F(OrientedFlakes, G11_G15_PhotonsAgreeWithPaths) {
    const std::vector<std::string> around = media("exterior", 1, 0.8), inside = media("", 1, 0.8);
    const std::string photonmap =
        "<integrator type='photonmap'>" + integer("global_photons", 1000) +
        integer("volume_photons", 60000) + integer("volume_lookup_size", 8) + "</integrator>";
    for (const std::size_t i : {0u, 2u}) {
        TestCamera camera{.to_world = look({0.1, -0.2, -0.9}, {0, 0, 1}), .fov = 20};
        camera.inside = inside[i];
        const std::string scene =
            shape("cube", "", boolean("flip_normals", true) + diffuse(0) + around[i]) +
            sphere({0.5, 0.6, 0.1}, 0.2, diffuse(0) + area_light(5) + around[i]) + xml(camera);
        EXPECT_TRUE(
            agree(image_means(photonmap + scene, 8, 16), image_means(volpath() + scene, 512), 0.03))
            << i;
    }
}

/// What the medium hides is in alpha: 1 − the transmittance.
TEST(AbsorbingSlab, AlphaIsWhatTheMediumHides) {
    const std::string medium = fog("interior", number("sigma_t", 0.8) + number("albedo", 0.5));
    const TestScene scene(volpath() + xml(along_z()) + slab(1, null_surface + medium));
    RunningStatistics alphas;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        alphas.add(pixel_statistics(scene.render({.per_pixel = 1024, .seed = seed}), 3).mean());
    }
    EXPECT_TRUE(agrees(alphas, 1 - std::exp(-0.8), 0.005));
}

/// A scene without media gets the bits of `path`.
TEST(Volpath, IsPathWithoutMedia) {
    const std::string scene =
        shape("rectangle", scale(3), diffuse(0.6)) + sphere({0, 0.5, 0.6}, 0.5, glass(1.5)) +
        sphere({-1, -0.4, 0.6}, 0.4,
               "<bsdf type='mask'>" + number("opacity", 0.4) + diffuse(0.8) + "</bsdf>") +
        shape("rectangle", scale(2) + translate({0, 0, 1.2}), null_surface) +
        shape("rectangle", scale(0.4) + look({0, 0, 2}, {0, 0, 0}), diffuse(0) + area_light(5)) +
        constant_light(0.2) +
        xml({.to_world = look({2, 3, 2.5}, {0, 0, 0.5}),
             .fov = 45,
             .width = 24,
             .height = 24,
             .sampler = "sobol"});
    for (const std::string& inside :
         {std::string(), integer("max_depth", 1), integer("max_depth", 3),
          boolean("hide_emitters", true), integer("rr_depth", 2)}) {
        const Samples samples{.per_pixel = 8};
        EXPECT_EQ(numbers_of(TestScene(volpath(inside) + scene).render(samples)),
                  numbers_of(TestScene(path_integrator(inside) + scene).render(samples)))
            << inside;
    }
}

TEST(Volpath, OtherIntegratorsSayThatMediaAreLeftOut) {
    const std::string scene =
        xml(along_z()) + slab(1, null_surface + fog("interior", number("sigma_t", 1)));
    EXPECT_EQ(TestScene(path_integrator() + scene).warnings(),
              "the media of this scene are left out: \"path\" renders none; \"volpath\" does\n");
    EXPECT_EQ(TestScene(volpath() + scene).warnings(), "");
}

}  // namespace
}  // namespace lucerna
