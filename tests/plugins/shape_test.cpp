// SPDX-License-Identifier: Apache-2.0
/// What every shape must satisfy, tried on all shape plugins that the registry finds, with defaults
/// and under hard transforms; then closed forms of single shapes. A new plugin is tested unasked.
#include "plugins/commands/contracts/shape.h"
#include "core/interfaces/bsdf.h"
#include "core/math/rounding.h"
#include "core/math/solid_angle.h"
#include "core/math/warp.h"
#include "plugins/shapes/mesh.h"
#include "tests/paths.h"
#include "tests/plugins/world.h"
#include "tests/statistics.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <map>

namespace lucerna {
namespace {

std::string shape(const std::string& type, const std::string& body = "") {
    return fmt::format("<shape type='{}'>{}</shape>", type, body);
}
std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}
std::string scaled(double factor) { return fmt::format("<scale value='{}'/>", factor); }

const char* const turned =
    "<rotate x='1' y='2' z='-0.5' angle='40'/><scale value='1.5'/>"
    "<translate x='0.3' y='-0.7' z='2'/>";
const char* const mirrored = "<scale x='-1' y='1' z='1'/><rotate y='1' angle='30'/>";
const char* const sheared = "<matrix value='1 0.6 0 1  0 1.3 0.2 0  0.3 0 0.7 -2  0 0 0 1'/>";

/// Files for the loaders: an octahedron with shared vertices and texture coordinates.
const TemporaryFolder& files() {
    static const TemporaryFolder folder;
    [[maybe_unused]] static const bool written = [] {
        std::ofstream(folder / "octahedron.obj")
            << "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
               "vt 0 0\nvt 1 0\nvt 0.4 0.9\n"
               "f 1/1 3/2 5/3\nf 3/1 2/2 5/3\nf 2/1 4/2 5/3\nf 4/1 1/2 5/3\n"
               "f 3/1 1/2 6/3\nf 2/1 3/2 6/3\nf 4/1 2/2 6/3\nf 1/1 4/2 6/3\n";
        std::ofstream(folder / "octahedron.ply")
            << "ply\nformat ascii 1.0\nelement vertex 6\n"
               "property float x\nproperty float y\nproperty float z\n"
               "element face 8\nproperty list uchar int vertex_indices\nend_header\n"
               "1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n"
               "3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n";
        return true;
    }();
    return folder;
}

std::string file(const std::string& name) {
    return fmt::format("<string name='filename' value='{}'/>", (files() / name).string());
}

/// What a plugin cannot be made without. Empty text: it has no surface, or its files are tested
/// elsewhere.
const std::map<std::string, std::string>& bodies() {
    static const std::map<std::string, std::string> all = {{"city",
                                                            "<string name='part' value='walls'/>"
                                                            "<integer name='size' value='1'/>"},
                                                           {"bsplinecurve", ""},
                                                           {"linearcurve", ""},
                                                           {"merge", ""},
                                                           {"obj", file("octahedron.obj")},
                                                           {"ply", file("octahedron.ply")},
                                                           {"sdfgrid", ""},
                                                           {"serialized", ""},
                                                           {"shapegroup", ""},
                                                           {"instance", ""}};
    return all;
}

struct Case {
    std::string xml;
    std::unique_ptr<World> world;

    const Shape& shape() const { return world->shape(); }
    const Scene& scene() const { return world->scene(); }
    contracts::ShapeTrial trial() const { return contracts::ShapeTrial(world->scene()); }
};

std::vector<std::string> all_shapes() {
    std::vector<std::string> all;
    Registry registry;
    for (const std::string& name : registry.names("shape")) {
        const auto body = bodies().find(name);
        if (body != bodies().end() && body->second.empty()) continue;
        const std::string inside = body == bodies().end() ? "" : body->second;
        all.push_back(shape(name, inside));
        for (const char* steps : {turned, mirrored}) {
            all.push_back(shape(name, inside + to_world(steps)));
        }
        for (const double scale : {1e-6, 1e6}) {
            all.push_back(shape(name, inside + to_world(scaled(scale))));
        }
        all.push_back(shape(name, inside + "<boolean name='flip_normals' value='true'/>"));
    }
    for (const char* name : {"rectangle", "disk", "cube"}) {
        all.push_back(shape(name, to_world(sheared)));
    }
    all.push_back(shape("obj", file("octahedron.obj") + to_world(sheared)));
    all.push_back(shape("sphere",
                        "<point name='center' value='3 -2 1'/>"
                        "<float name='radius' value='0.25'/>"));
    all.push_back(shape("cylinder",
                        "<point name='p0' value='1 2 3'/>"
                        "<point name='p1' value='-1 0.5 3.3'/>"
                        "<float name='radius' value='0.1'/>"));
    return all;
}

constexpr Effort effort{};
/// Of each case: together they err once in a hundred runs with other seeds.
const double level = sidak(1e-2, 100);

class Shapes : public testing::Test {
protected:
    static void SetUpTestSuite() {
        for (const std::string& xml : all_shapes()) {
            try {
                cases.push_back({xml, std::make_unique<World>(xml)});
            } catch (const Error& error) {
                ADD_FAILURE() << xml << "\ncannot be made; if it needs parameters or files, add "
                              << "them to `bodies` in this file\n"
                              << error.what();
            }
        }
    }
    static void TearDownTestSuite() { cases.clear(); }

    static inline std::vector<Case> cases;
};

Receiver receiver_at(Vector3 p) { return {.p = p}; }

TEST_F(Shapes, every_plugin_is_found_and_can_be_made) {
    Registry registry;
    EXPECT_GE(registry.names("shape").size(), 10u);
    EXPECT_GE(cases.size(), 40u);
}

TEST_F(Shapes, C21_points_sampled_by_area_lie_on_the_surface) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_samples(c.trial(), effort))) << c.xml;
    }
}

TEST_F(Shapes, areas_are_those_that_random_lines_measure) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_areas(c.trial(), {.samples = 50000}), level)) << c.xml;
    }
}

TEST_F(Shapes, C3_C23_density_per_solid_angle_covers_what_is_visible) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_solid_angles(c.trial(), effort), level)) << c.xml;
    }
}

/// Of meshes, by looking at every triangle in double: Embree uses what the processor has.
TEST_F(Shapes, A12_A22_nearest_hit_is_found) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_hits(c.trial(), effort))) << c.xml;
    }
}

TEST_F(Shapes, B8_B11_points_are_on_the_surface_within_their_error) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_errors(c.trial(), effort))) << c.xml;
    }
}

TEST_F(Shapes, samples_of_many_lanes_are_those_of_each) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_lanes(c.trial(), effort))) << c.xml;
    }
}

TEST_F(Shapes, I2_normals_of_closed_shapes_point_outside_also_when_mirrored) {
    for (const Case& c : cases) {
        if (c.xml.find("city") != std::string::npos) continue;
        if (c.xml.find("rectangle") != std::string::npos) continue;
        if (c.xml.find("disk") != std::string::npos) continue;
        const float side = c.xml.find("flip_normals") == std::string::npos ? 1.0f : -1.0f;
        Rng rng(2);
        for (int i = 0; i < 200; ++i) {
            const auto primitive = rng.next_uint() % c.shape().primitive_count();
            const SurfaceSample s = c.shape().sample_area(primitive, rng.next_float2());
            EXPECT_GT(side * glm::dot(s.n, s.p - c.shape().bounds().center()), 0) << c.xml;
        }
    }
}

TEST_F(Shapes, I3_derivatives_follow_the_parameters) {
    for (const Case& c : cases) {
        EXPECT_TRUE(holds(contracts::shape_derivatives(c.trial(), effort))) << c.xml;
    }
}

TEST(Shape, areas_are_those_of_the_books) {
    const std::map<std::string, double> expected = {
        {"sphere", 4 * std::numbers::pi},
        {"cylinder", 2 * std::numbers::pi},
        {"disk", std::numbers::pi},
        {"rectangle", 4},
        {"cube", 24},
    };
    for (const auto& [name, area] : expected) {
        const World world(shape(name, to_world(scaled(3))));
        double sum = 0;
        for (std::uint32_t i = 0; i < world.shape().primitive_count(); ++i) {
            sum += world.shape().area(i);
        }
        EXPECT_NEAR(sum / (9 * area), 1, 1e-6) << name;
    }
    // An ellipse with half axes 2 and 3.
    const World ellipse(shape("disk", to_world("<scale x='2' y='3' z='5'/>")));
    EXPECT_NEAR(ellipse.shape().area(0), 6 * std::numbers::pi, 1e-5);
}

TEST(Shape, sampling_by_area_is_uniform) {
    const std::map<std::string, double> bands = {{"sphere", 2}, {"cylinder", 1}, {"disk", 0}};
    for (const auto& [name, height] : bands) {
        const World world(shape(name));
        Rng rng(1);
        std::vector<double> counts(80), expected(80, 1000);
        for (int i = 0; i < 80000; ++i) {
            const Vector3 p = world.shape().sample_area(0, rng.next_float2()).p;
            // Bands of equal area: in z on the sphere and the cylinder, in r² on the disk.
            const double z = name == "sphere" ? 0.5 * (p.z + 1) : p.z;
            const double across = height > 0 ? z : p.x * p.x + p.y * p.y;
            const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
            const int row = std::clamp(static_cast<int>(8 * across), 0, 7);
            const int column = std::clamp(static_cast<int>(10 * turn), 0, 9);
            ++counts[static_cast<std::size_t>(10 * row + column)];
        }
        EXPECT_TRUE(counts_match(counts, expected)) << name;
    }
}

// Spheres.

std::string sphere(const std::string& center, double radius) {
    return shape("sphere", fmt::format("<point name='center' value='{}'/>"
                                       "<float name='radius' value='{}'/>",
                                       center, radius));
}

TEST(Sphere, A1_far_away_it_is_met_as_exactly_as_a_float_can_say) {
    const World world(sphere("0 0 0", 1));
    for (const double distance : {1e1, 1e3, 1e4, 1e5, 1e6}) {
        const Vector3 o(0, 0, static_cast<float>(-distance));
        const auto hit = world.scene().intersect({.o = o, .d = {0, 0, 1}});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->t, distance - 1, 0.5 * std::nextafter(distance, 1e9) * 0x1p-23);
        EXPECT_FLOAT_EQ(hit->p.z, -1);
        // Off the axis: the true point is (0.6, 0, −0.8).
        const auto side = world.scene().intersect({.o = o + Vector3(0.6f, 0, 0), .d = {0, 0, 1}});
        ASSERT_TRUE(side);
        EXPECT_NEAR(side->p.z, -0.8, 1e-6) << distance;
    }
}

TEST(Sphere, A2_horizon_of_a_planet) {
    // From 1.7 m above a sea of radius 6.4e6 m the horizon is √(2rh + h²) away. In a camera's
    // space: the ground is at z = 0, the center far below.
    const double r = 6.4e6, h = 1.7;
    const World world(sphere("0 0 -6400000", r));
    const double horizon = std::sqrt(2 * r * h + h * h);
    EXPECT_NEAR(horizon, 4664.8, 0.05);
    const double dip = std::atan2(horizon, r);  // of the tangent below the horizontal
    double met = 0, missed = infinity;
    for (int i = -50; i <= 50; ++i) {
        const double angle = dip * (1 + 1e-3 * i);
        const Vector3 d(Vector3d(std::cos(angle), 0, -std::sin(angle)));
        const auto hit = world.scene().intersect({.o = {0, 0, 1.7f}, .d = d});
        if (hit) met = std::max(met, static_cast<double>(hit->t));
        if (!hit) missed = std::min(missed, std::abs(static_cast<double>(i)));
    }
    EXPECT_NEAR(met / horizon, 1, 0.05);
    EXPECT_LE(missed, 1);
    const auto foot = world.scene().intersect({.o = {0, 0, 1.7f}, .d = {0, 0, -1}});
    ASSERT_TRUE(foot);
    EXPECT_FLOAT_EQ(foot->t, 1.7f);
    // A second look from nearby sees the same flat sea: no waves of rounding.
    for (int i = 1; i < 100; ++i) {
        const float x = 0.37f * static_cast<float>(i);
        const auto at = world.scene().intersect({.o = {x, 0, 1.7f}, .d = {0, 0, -1}});
        ASSERT_TRUE(at);
        EXPECT_NEAR(at->t, 1.7 + x * x / (2 * r), 1e-6);
    }
}

TEST(Sphere, A3_tiny_ones_are_hit_where_they_are) {
    for (const double x : {0.0, 1000.0}) {
        const double r = 1e-6 * std::max(x, 1.0) * 1e3;  // some roundings of its place
        const World world(sphere(fmt::format("{} 0 0", x), r));
        const float radius = static_cast<float>(r);
        const auto ray = [&](float impact) {
            return Ray{.o = {static_cast<float>(x), impact, -5}, .d = {0, 0, 1}};
        };
        EXPECT_TRUE(world.scene().intersect(ray(0.99f * radius)));
        EXPECT_FALSE(world.scene().intersect(ray(1.01f * radius)));
    }
}

TEST(Sphere, A4_ray_that_starts_inside_leaves_once) {
    const World world(sphere("0 0 0", 2));
    Rng rng(4);
    for (int i = 0; i < 1000; ++i) {
        const Vector3 d = square_to_uniform_sphere(rng.next_float2());
        const auto hit = world.scene().intersect({.o = Vector3(0), .d = d});
        ASSERT_TRUE(hit);
        EXPECT_NEAR(hit->t, 2, 1e-6);
        EXPECT_LT(glm::length(hit->p - 2.0f * d), 2e-6f);
        // From the point itself: outwards nothing, inwards the other side.
        EXPECT_FALSE(world.scene().intersect(hit->spawn_ray(d)));
        const auto across = world.scene().intersect(hit->spawn_ray(-d));
        ASSERT_TRUE(across);
        EXPECT_NEAR(across->t, 4, 1e-5);
    }
}

TEST(Sphere, A5_grazing_rays_decide_once_between_hit_and_miss) {
    const World world(sphere("0 0 0", 1));
    for (const float distance : {3.0f, 1e3f, 1e6f}) {
        bool missed = false;
        for (int i = -1000; i <= 1000; ++i) {
            const float impact = 1 + static_cast<float>(i) * 0x1p-23f;
            const auto hit = world.scene().intersect({.o = {impact, 0, -distance}, .d = {0, 0, 1}});
            EXPECT_EQ(!hit, impact > 1) << impact;
            missed |= !hit;
            EXPECT_TRUE(!missed || !hit);
        }
    }
}

TEST(Sphere, C1_far_light_keeps_its_density) {
    const World world(sphere("0 0 0", 1));
    for (const double distance : {2.0, 1e3, 1e4, 1e6}) {
        const Receiver from = receiver_at({0, static_cast<float>(distance), 0});
        const double sin2 = 1 / (distance * distance);
        const double solid_angle = 2 * std::numbers::pi * sin2 / (1 + std::sqrt(1 - sin2));
        const auto sample = world.shape().sample_solid_angle(0, from, {0.3f, 0.8f});
        ASSERT_TRUE(sample);
        EXPECT_NEAR(sample->pdf * solid_angle, 1, 8 * 0x1p-24);
    }
}

/// ∫ max(n·w, 0) dw over the visible part of the shape, by its own samples.
RunningStatistics irradiance(const Shape& shape, Vector3 p, Vector3 n, int samples = 200000) {
    Rng rng(8);
    RunningStatistics mean;
    const std::uint32_t count = shape.primitive_count();
    for (int i = 0; i < samples; ++i) {
        const auto primitive = static_cast<std::uint32_t>(i) % count;
        const auto s = shape.sample_solid_angle(primitive, receiver_at(p), rng.next_float2());
        if (!s) {
            mean.add(0);
            continue;
        }
        const Vector3 d = glm::normalize(s->p - p);
        const bool lit = glm::dot(d, s->n) < 0;  // the normal side of the light
        mean.add(lit ? static_cast<float>(count) * std::max(glm::dot(d, n), 0.0f) / s->pdf : 0.0f);
    }
    return mean;
}

TEST(Sphere, C2_from_inside_a_glowing_sphere_the_irradiance_is_pi) {
    const World world(
        shape("sphere", "<boolean name='flip_normals' value='true'/>" + to_world(scaled(3))));
    for (const Vector3 p : {Vector3(0), {1, 0.5f, -0.3f}, {0, 2.5f, 0}}) {
        const Vector3 n = glm::normalize(Vector3(0.3f, -0.5f, 0.8f));
        EXPECT_TRUE(equivalent(irradiance(world.shape(), p, n, 2000000), std::numbers::pi, 1e-2));
    }
}

TEST(Sphere, C3_C4_light_that_touches_or_sets_behind_the_horizon) {
    const World world(sphere("0 0 0", 1));
    // Distance 3 radii; the normal makes an angle with the direction to the center.
    const std::map<double, double> expected = {
        {0.5, 0.174532925}, {0.2, 0.072810967}, {0, 0.025567229}, {-0.2, 0.002997797}};
    for (const auto& [cosine, value] : expected) {
        const Vector3 n(Vector3d(-cosine, std::sqrt(1 - cosine * cosine), 0));
        const double tolerance = cosine < 0 ? 0.02 : 5e-3;
        EXPECT_TRUE(equivalent(irradiance(world.shape(), {3, 0, 0}, n, 1500000), value, tolerance));
    }
    // Just above the surface it fills half of all directions.
    const Receiver near = receiver_at({0, 0, 1 + 1e-4f});
    Interaction at;
    EXPECT_NEAR(world.shape().pdf_solid_angle(0, near, {0, 0, -1}, at) * 2 * std::numbers::pi, 1,
                0.02);
}

TEST(Sphere, C5_radius_zero_is_refused) {
    EXPECT_EQ(refusal(sphere("0 0 0", 0)), "\"radius\" is 0, but must be > 0");
}

TEST(Sphere, A20_stretching_is_refused_with_the_factors) {
    EXPECT_EQ(refusal(shape("sphere", to_world("<scale x='1' y='2' z='1'/>"))),
              "\"to_world\" stretches x, y and z by 1, 2 and 1, but a sphere must stay round: "
              "scale all axes alike, or use a mesh");
    EXPECT_EQ(refusal(shape("cylinder", to_world("<scale x='3' y='1' z='1'/>"))),
              "\"to_world\" stretches x, y and z by 3, 1 and 1, but a cylinder must stay round: "
              "scale all directions across its axis alike, or use a mesh");
    // Sheared: the axis is no longer perpendicular to the circle.
    EXPECT_NE(refusal(shape("cylinder", to_world("<matrix value='1 0 1 0  0 1 0 0  0 0 1 0  0 0 0 "
                                                 "1'/>"))),
              "");
}

/// Along its axis a cylinder can be stretched: it is the same as one with other ends.
TEST(Cylinder, A20_stretched_along_the_axis_is_a_longer_one) {
    const World stretched(
        shape("cylinder",
              "<point name='p0' value='0 1 0'/><point name='p1' value='0 3 0'/>"
              "<float name='radius' value='0.5'/>" +
                  to_world("<scale x='1.5' y='4' z='1.5'/><rotate x='1' angle='90'/>")));
    const World same(shape("cylinder",
                           "<point name='p0' value='0 0 4'/><point name='p1' value='0 0 12'/>"
                           "<float name='radius' value='0.75'/>"));
    EXPECT_NEAR(stretched.shape().area(0), 2 * pi * 0.75 * 8, 1e-5);
    Rng rng(1);
    int hits = 0;
    for (int i = 0; i < 1000; ++i) {
        const float angle = 2 * pi * rng.next_float(), z = 3 + 10 * rng.next_float();
        const Vector3 from(3 * std::cos(angle), 3 * std::sin(angle), z);
        const Ray ray{.o = from, .d = glm::normalize(Vector3(0.3f, -0.2f, z) - from)};
        const auto a = stretched.scene().intersect(ray), b = same.scene().intersect(ray);
        ASSERT_EQ(a.has_value(), b.has_value()) << z;
        if (!a) continue;
        ++hits;
        EXPECT_LT(glm::distance(a->p, b->p), 1e-5f);
        EXPECT_LT(glm::distance(a->n, b->n), 1e-5f);
        EXPECT_NEAR(a->uv.y, b->uv.y, 1e-5f);
        EXPECT_LT(glm::distance(a->dpdv, b->dpdv), 1e-4f);
    }
    EXPECT_GT(hits, 700);
}

TEST(Shape, K14_capital_letters_in_the_name_of_a_plugin_are_told) {
    const World world("<shape type='Sphere'><bsdf type='Disney'/></shape>");
    EXPECT_EQ(world.shape().primitive_count(), 1u);
    std::string warnings;
    for (const Diagnostic& d : world.diagnostics().all()) warnings += d.message + "\n";
    EXPECT_EQ(warnings,
              "shape \"Sphere\" is taken for \"sphere\"\n"
              "bsdf \"Disney\" is taken for \"disney\"\n");
    EXPECT_NE(refusal("<shape type='Spheer'/>").find("did you mean \"sphere\"?"),
              std::string::npos);
}

/// As in Mitsuba.
TEST(Shape, what_emits_reflects_nothing_unless_it_is_told_to) {
    const std::string glow = "<emitter type='area'/>";
    const Interaction anywhere;
    const auto reflected = [&](const std::string& inside) {
        const World world(shape("sphere", inside));
        return world.shape().bsdf()->albedo(anywhere, {0, 0, 1}).x;
    };
    EXPECT_EQ(reflected(glow), 0);
    EXPECT_EQ(reflected(""), 0.5f);
    EXPECT_EQ(reflected(glow + "<bsdf type='diffuse'/>"), 0.5f);
    const World lamp(shape("sphere", glow));
    EXPECT_EQ(lamp.shape().bsdf()->lobes(), Lobe::none);
    EXPECT_FALSE(lamp.shape().bsdf()->sample(anywhere, {0, 0, 1}, 0, {}, TransportMode::radiance));
}

TEST(Shape, what_cannot_be_is_refused) {
    EXPECT_EQ(refusal(shape("cylinder", "<point name='p1' value='0 0 0'/>")),
              "\"p0\" and \"p1\" are the same point: the cylinder has no length");
    EXPECT_EQ(refusal(shape("sphere", "<emitter type='point'/>")),
              "this emitter cannot be part of a shape; put it directly into the scene, or use an "
              "\"area\" emitter here");
    EXPECT_EQ(refusal(shape("rectangle",
                            to_world("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0.5 0 1'/>"))),
              "\"to_world\" of a shape must be affine: the last row of its matrix must be 0 0 0 1");
}

// Rectangles and triangles as lights.

TEST(Rectangle, C9_density_is_exact_from_tiny_to_large) {
    const World world(shape("rectangle"));
    for (const double height : {0.1, 1.0, 2.0, 10.0, 100.0, 1e4, 1e6}) {
        const double solid_angle = 4 * std::asin(1 / (1 + height * height));
        const Receiver from = receiver_at({0, 0, static_cast<float>(height)});
        const auto s = world.shape().sample_solid_angle(0, from, {0.5f, 0.5f});
        ASSERT_TRUE(s);
        // Sampled by area beyond its diagonal: at its centre the density is then d² / A.
        const double expected = height < 2.8 ? 1 / solid_angle : height * height / 4;
        EXPECT_NEAR(s->pdf / expected, 1, 1e-6) << height;
    }
}

TEST(Rectangle, C8_from_its_own_plane_there_is_nothing_to_sample) {
    for (const std::string& xml : {shape("rectangle"), shape("disk"), shape("cube")}) {
        const World world(xml);
        const float z = xml.find("cube") == std::string::npos ? 0.0f : 1.0f;
        for (const Vector3 p : {Vector3(3, 0.2f, z), Vector3(1, 0.2f, z), Vector3(0.1f, 0.2f, z)}) {
            Rng rng(1);
            for (int i = 0; i < 1000; ++i) {
                const auto primitive = rng.next_uint() % world.shape().primitive_count();
                const auto s =
                    world.shape().sample_solid_angle(primitive, receiver_at(p), rng.next_float2());
                if (s) {
                    EXPECT_TRUE(std::isfinite(s->pdf) && s->pdf > 0);
                }
            }
        }
    }
}

TEST(Mesh, C6_C7_a_square_of_two_triangles_lights_as_the_closed_form_says) {
    // A square of side 2 at distance h from a parallel receiver on its axis (Howell's catalogue of
    // configuration factors, C-11, for each quadrant).
    const World rectangle(shape("rectangle"));
    std::ofstream(files() / "square.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    const World triangles(shape("obj", file("square.obj")));
    for (const double h : {1e-3, 0.05, 1.0, 30.0, 1e3}) {
        const double a = 1 / std::sqrt(1 + h * h);
        const double expected = 4 * a * std::atan(a);
        const Vector3 p(0, 0, static_cast<float>(h));
        for (const World* world : {&rectangle, &triangles}) {
            // So near, a rectangle is sampled by area, which is right but very noisy.
            if (world == &rectangle && h < 0.01) continue;
            EXPECT_TRUE(equivalent(irradiance(world->shape(), p, {0, 0, -1}), expected, 0.01)) << h;
        }
    }
}

// Groups and instances.

TEST(Instance, B11_shows_what_the_shape_itself_would) {
    const std::string steps =
        "<scale x='2' y='0.5' z='-1.5'/><rotate x='1' angle='30'/><translate x='1' y='2' z='3'/>";
    const std::string bumpy =  // which uses tangents
        "<bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='diffuse'/></bsdf>";
    const World direct(shape("cube", bumpy + to_world(steps)));
    const World placed("<shape type='shapegroup' id='g'>" + shape("cube", bumpy) + "</shape>" +
                       shape("instance", "<ref id='g'/>" + to_world(steps)));
    Rng rng(6);
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vector3 target =
            Vector3(1, 2, 3) + 2.0f * square_to_uniform_sphere(rng.next_float2());
        const Vector3 o(10, -4, 7);
        const Ray ray{.o = o, .d = glm::normalize(target - o)};
        const auto a = direct.scene().intersect(ray), b = placed.scene().intersect(ray);
        ASSERT_EQ(a.has_value(), b.has_value()) << i;
        if (!a) continue;
        ++hits;
        EXPECT_LT(glm::length(a->p - b->p), 1e-5f);
        EXPECT_GT(glm::dot(a->n, b->n), 0.99999f);
        EXPECT_LT(glm::length(a->uv - b->uv), 1e-4f);
        EXPECT_LT(glm::length(a->dpdu - b->dpdu), 1e-4f * glm::length(a->dpdu));
        EXPECT_FALSE(placed.scene().intersect(b->spawn_ray(b->n)));
    }
    EXPECT_GT(hits, 500);
    const Bounds3 box = placed.scene().bounds(), expected = direct.scene().bounds();
    EXPECT_LT(glm::length(box.min - expected.min), 1e-5f);
    EXPECT_LT(glm::length(box.max - expected.max), 1e-5f);
}

TEST(Instance, P8_a_group_is_placed_by_its_instances_only) {
    const World world("<shape type='shapegroup' id='g'>" + to_world("<translate x='5'/>") +
                      shape("sphere") + "</shape>" + shape("instance", "<ref id='g'/>"));
    EXPECT_LT(glm::distance(world.scene().bounds().max, Vector3(1)), 1e-5f);
    ASSERT_FALSE(world.diagnostics().all().empty());
    EXPECT_EQ(world.diagnostics().all()[0].message,
              "\"to_world\" has no effect: each instance places the group by its own");
}

TEST(Instance, hits_depend_on_nothing_that_was_hit_before) {
    const World world("<shape type='shapegroup' id='g'>" + shape("cube") + "</shape>" +
                      shape("instance", "<ref id='g'/>" + to_world("<scale x='9' y='7' z='8'/>"
                                                                   "<rotate x='1' angle='40'/>")));
    Rng rng(8);
    TracedRay traced;
    TracedRay* const rays[] = {&traced};
    for (int i = 0; i < 200; ++i) {
        const Vector3 target = 3.0f * square_to_uniform_sphere(rng.next_float2());
        const Vector3 o(50, -30, 40);
        traced.ray = {.o = o, .d = glm::normalize(target - o)};
        world.scene().intersect(rays);
        const auto alone = world.scene().intersect(traced.ray);
        ASSERT_TRUE(traced.hit && alone);
        EXPECT_EQ(traced.hit->shading.s, alone->shading.s);
        EXPECT_EQ(traced.hit->shading.t, alone->shading.t);
    }
}

TEST(Merge, shows_its_shapes_where_they_are) {
    const std::string shapes =
        shape("cube", to_world(turned)) +
        shape("sphere", "<point name='center' x='2' y='1' z='0'/><bsdf type='conductor'/>");
    const World direct(shapes), merged(shape("merge", shapes));
    Rng rng(9);
    int hits = 0;
    for (int i = 0; i < 4000; ++i) {
        const Vector3 o = 20.0f * square_to_uniform_sphere(rng.next_float2());
        const Vector3 target = 3.0f * square_to_uniform_sphere(rng.next_float2());
        const Ray ray{.o = o, .d = glm::normalize(target - o)};
        const auto a = direct.scene().intersect(ray), b = merged.scene().intersect(ray);
        ASSERT_EQ(a.has_value(), b.has_value()) << i;
        if (!a) continue;
        ++hits;
        EXPECT_LT(glm::length(a->p - b->p), 1e-5f);
        EXPECT_GT(glm::dot(a->n, b->n), 0.99999f);
        EXPECT_EQ(a->shape->bsdf()->lobes(), b->shape->bsdf()->lobes());
    }
    EXPECT_GT(hits, 500);
    EXPECT_EQ(merged.scene().bounds().min, direct.scene().bounds().min);
    EXPECT_EQ(merged.scene().bounds().max, direct.scene().bounds().max);
    EXPECT_EQ(refusal(shape("merge", shape("sphere", "<emitter type='area'/>"))),
              "a shape of a merge has an emitter, which instances cannot carry; put the emitting "
              "shape directly into the scene");
    EXPECT_NE(refusal(shape("merge", "")), "");
}

TEST(Instance, what_cannot_be_shown_is_refused) {
    EXPECT_EQ(refusal(shape("instance")),
              "an instance needs a shapegroup: <shape type=\"shapegroup\" id=\"tree\">…</shape> in "
              "the scene, and <ref id=\"tree\"/> in the instance");
    EXPECT_EQ(refusal(shape("shapegroup", shape("sphere", "<emitter type='area'/>"))),
              "a shape of a shapegroup has an emitter, which instances cannot carry; put the "
              "emitting shape directly into the scene, once for each instance");
    EXPECT_EQ(refusal(shape("shapegroup", shape("shapegroup", shape("sphere")))),
              "a shapegroup holds another shapegroup or an instance; only one level of instancing "
              "is possible, so list the shapes themselves");
}

}  // namespace
}  // namespace lucerna
