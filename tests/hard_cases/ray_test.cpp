// SPDX-License-Identifier: Apache-2.0
/// Rays against whole scenes: closed meshes do not leak, odd rays harm nothing.
#include "core/math/warp.h"
#include "core/scene/ray_statistics.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <limits>
#include <random>

namespace lucerna {
namespace {

/// Random numbers for tests.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float number() { return static_cast<float>(uniform_(engine_)) * 0x1p-24f; }
    Vector2 pair() {
        const float x = number(), y = number();
        return {x, y};
    }
    Vector3 direction() { return square_to_uniform_sphere(pair()); }
    Vector3 in_box(float half) {
        const float x = number(), y = number(), z = number();
        return half * (2.0f * Vector3(x, y, z) - 1.0f);
    }

private:
    std::mt19937 engine_;
    std::uniform_int_distribution<int> uniform_{0, (1 << 24) - 1};
};

std::string mesh(const std::string& file, const std::string& steps, const std::string& inside) {
    return shape("obj", steps, "<string name='filename' value='" + file + "'/>" + inside);
}

/// The unit sphere as 20 000 triangles, moved.
class ClosedMesh {
public:
    explicit ClosedMesh(const std::string& steps) {
        write_file(folder_ / "sphere.obj", sphere_obj(72, false));
        scene_ = std::make_unique<TestScene>(mesh("sphere.obj", steps, ""), folder_.path());
    }
    const Scene& scene() const { return scene_->scene(); }
    TriangleGeometry triangles() const {
        return std::get<TriangleGeometry>(scene().shapes().front()->geometry());
    }

private:
    TemporaryFolder folder_;
    std::unique_ptr<TestScene> scene_;
};

/// How many of the rays from within leave.
int leaks(const Scene& scene, int rays, const std::function<Ray()>& make) {
    int count = 0;
    for (int i = 0; i < rays; ++i) {
        const Ray ray = make();
        const bool hit = scene.intersect(ray).has_value(), blocked = scene.occluded(ray);
        EXPECT_EQ(hit, blocked);
        count += !hit;
    }
    return count;
}

struct Placement {
    std::string steps;
    Vector3 center;
    float radius;
};
/// Not so far away that the scene would be moved to the origin.
const std::vector<Placement> placements = {
    {"", {0, 0, 0}, 1},
    {translate({100, 100, 100}), {100, 100, 100}, 1},
    {scale(200) + translate({148376, 1234, -223423}), {148376, 1234, -223423}, 200}};

TEST(ClosedMeshes, A7_A21_RandomRaysDoNotLeak) {
    for (const Placement& at : placements) {
        const ClosedMesh mesh(at.steps);
        Random random(1);
        const int count = leaks(mesh.scene(), 300000, [&] {
            const Vector3 o = at.center + random.in_box(0.3f * at.radius);
            return Ray{.o = o, .d = random.direction()};
        });
        EXPECT_EQ(count, 0) << at.steps;
    }
}

TEST(ClosedMeshes, A6_A7_RaysAimedAtEdgesAndVertices) {
    for (const Placement& at : placements) {
        const ClosedMesh mesh(at.steps);
        const TriangleGeometry triangles = mesh.triangles();
        Random random(2);
        const auto aimed = [&](bool at_vertex) {
            return leaks(mesh.scene(), 50000, [&] {
                const auto count = static_cast<float>(triangles.indices.size() / 3);
                const auto i = 3 * static_cast<std::size_t>(random.number() * count);
                const Vector3 a = triangles.positions[triangles.indices[i]];
                const Vector3 b = triangles.positions[triangles.indices[i + 1]];
                const float t = at_vertex ? 0.0f : random.number();
                const Vector3 o = at.center + random.in_box(0.3f * at.radius);
                return Ray{.o = o, .d = glm::normalize(a + t * (b - a) - o)};
            });
        };
        EXPECT_LE(aimed(false), 1) << at.steps;
        EXPECT_LE(aimed(true), 1000) << at.steps;  // Embree has known cracks at vertices
    }
}

TEST(ClosedMeshes, A22_TheFrontOfAConvexBodyIsHitFirst) {
    const ClosedMesh mesh("");
    Random random(3);
    int hits = 0, backs = 0;
    for (int i = 0; i < 200000; ++i) {
        const Vector3 o = 3.0f * random.direction(), target = random.in_box(1);
        const Ray ray{.o = o, .d = glm::normalize(target - o)};
        const auto at = mesh.scene().intersect(ray);
        hits += at.has_value();
        backs += at && glm::dot(at->n, ray.d) >= 0;
    }
    EXPECT_GT(hits, 50000);
    EXPECT_EQ(backs, 0);
}

TEST(ClosedMeshes, A8_InsideAndOutsideAlternateAlongARay) {
    const ClosedMesh mesh("");
    Random random(4);
    int odd = 0;
    for (int i = 0; i < 50000; ++i) {
        const Vector3 o = 3.0f * random.direction();
        Ray ray{.o = o, .d = glm::normalize(random.in_box(0.9f) - o)};
        int crossings = 0;
        while (const auto at = mesh.scene().intersect(ray)) {
            ++crossings;
            ray = at->spawn_ray(ray.d);
        }
        odd += crossings % 2;
    }
    EXPECT_EQ(odd, 0);
}

/// Strips a thousand times longer than wide, seen edge-on: hits lie where the triangle is.
/// The largest distance from the second focus of a mirror of half axes 5, 3, 3 at which rays pass
/// that left the first one: a ball of 4 n² smooth triangles that is stretched.
float miss_of_focus(int n) {
    const TemporaryFolder folder;
    write_file(folder / "sphere.obj", sphere_obj(n, true));
    const TestScene mirror(mesh("sphere.obj", "<scale x='5' y='3' z='3'/>", ""), folder.path());
    const Vector3 first(-4, 0, 0), second(4, 0, 0);
    Random random(7);
    float worst = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto hit = mirror.scene().intersect({.o = first, .d = random.direction()});
        EXPECT_TRUE(hit);
        if (!hit) continue;
        const Vector3 wo = glm::normalize(first - hit->p);
        const Vector3 wi = hit->to_world(reflect(hit->to_local(wo)));
        worst = std::max(worst, glm::length(glm::cross(second - hit->p, wi)));
        EXPECT_NEAR(glm::distance(first, hit->p) + glm::distance(hit->p, second), 10,
                    100.0 / (n * n));
    }
    return worst;
}

TEST(ClosedMeshes, O21_I3_AnEllipsoidMirrorsOneFocusToTheOther) {
    const float coarse = miss_of_focus(32), fine = miss_of_focus(128);
    EXPECT_LT(fine, 0.02f);
    // The error of position and normal falls with the square of the size of triangles.
    EXPECT_LT(fine, coarse / 8);
}

TEST(ManyRays, MeetWhatEachMeetsAlone) {
    const ClosedMesh mesh("<scale x='1' y='0.3' z='1'/>");
    const Scene& scene = mesh.scene();
    Random random(11);
    std::vector<TracedRay> rays(150);
    std::vector<TracedRay*> pointers;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Vector3 o = random.in_box(2), target = random.in_box(0.3f);
        rays[i].ray = {.o = o, .d = glm::normalize(target - o)};
        if (i % 50 == 7) rays[i].ray.d.x = infinity;
        if (i % 3 == 0) {  // starts on the surface, and must not meet it there
            if (const auto at = scene.intersect(rays[i].ray)) {
                rays[i].ray = at->spawn_ray(random.direction());
            }
        }
        pointers.push_back(&rays[i]);
    }
    const RayStatistics before = ray_statistics();
    scene.intersect(pointers);
    const RayStatistics middle = ray_statistics();
    int hits = 0;
    for (const TracedRay& traced : rays) {
        const std::optional<Interaction> alone = scene.intersect(traced.ray);
        ASSERT_EQ(traced.hit.has_value(), alone.has_value());
        if (!alone) continue;
        ++hits;
        EXPECT_EQ(traced.hit->p, alone->p);
        EXPECT_EQ(traced.hit->t, alone->t);
        EXPECT_EQ(traced.hit->shading.s, alone->shading.s);
        EXPECT_EQ(traced.hit->source, alone->source);
    }
    EXPECT_GT(hits, 30);
    const RayStatistics after = ray_statistics();
    EXPECT_EQ(middle.intersections - before.intersections,
              after.intersections - middle.intersections);
    EXPECT_EQ(middle.dropped - before.dropped, 3u);
}

TEST(Slivers, A11_DistancesAreThoseOfTheTriangle) {
    const TemporaryFolder folder;
    Random random(5);
    std::string text;
    for (int i = 0; i < 200; ++i) {
        const Vector3 a = random.in_box(5), along = 10.0f * random.direction();
        const Vector3 c = a + 0.5f * along + 0.01f * random.direction();
        for (const Vector3& v : {a, a + along, c}) {
            text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
        }
        text += "f -3 -2 -1\n";
    }
    write_file(folder / "slivers.obj", text);
    const TestScene test(mesh("slivers.obj", "", ""), folder.path());
    const auto triangles = std::get<TriangleGeometry>(test.scene().shapes().front()->geometry());
    int hits = 0, wrong = 0;
    for (int i = 0; i < 400000; ++i) {
        const auto t = 3 * static_cast<std::size_t>(200 * random.number());
        const Vector3 a = triangles.positions[triangles.indices[t]];
        const Vector3 b = triangles.positions[triangles.indices[t + 1]];
        const Vector3 c = triangles.positions[triangles.indices[t + 2]];
        // From near the plane of the triangle, along it.
        const Vector3 o = a + 2.0f * (a - b) * random.number() + 1e-3f * random.direction();
        const float u = random.number();
        const Vector3 target = a + u * (b - a) + 0.5f * (c - a) * random.number();
        const Ray ray{.o = o, .d = glm::normalize(target - o)};
        const auto at = test.scene().intersect(ray);
        if (!at) continue;
        ++hits;
        const float distance = glm::dot(at->p - o, ray.d);
        // What the scene lets pass: a thousandth, and the error of the point.
        wrong += !(std::abs(distance - at->t) <= 2e-3f * std::max(1.0f, at->t)) || at->t > 60;
    }
    EXPECT_GT(hits, 10000);
    EXPECT_EQ(wrong, 0);
}

/// Rays that no scene should make, but bugs do: dropped and counted, never passed to Embree.
TEST(OddRays, A16_A17_AreDroppedAndCounted) {
    const TestScene test(sphere({0, 0, 0}, 1, "") + shape("cube", translate({3, 0, 0}), "") +
                         shape("rectangle", translate({0, 0, 4}), ""));
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Ray> rays;
    for (const float bad : {nan, infinity, -infinity, 1e19f, -3e38f}) {
        for (int axis = 0; axis < 3; ++axis) {
            Ray from{.o = {0, 0, 0}, .d = {0, 0, 1}}, along = from;
            from.o[axis] = bad;
            along.d[axis] = bad;
            rays.push_back(from);
            rays.push_back(along);
        }
    }
    for (const float tmax : {nan, -1.0f, -infinity}) {
        rays.push_back({.o = {0, 0, 0}, .d = {0, 0, 1}, .tmax = tmax});
    }
    rays.push_back({.o = {0, 0, 0}, .d = {0, 0, 0}});
    const std::uint64_t before = ray_statistics().dropped;
    for (const Ray& ray : rays) {
        EXPECT_FALSE(test.scene().intersect(ray));
        EXPECT_TRUE(test.scene().occluded(ray));  // nothing is lit through a broken ray
    }
    EXPECT_EQ(ray_statistics().dropped - before, 2 * rays.size());
    // Unusual, but right:
    EXPECT_FALSE(test.scene().intersect({.o = {0, 0, 0}, .d = {0, 0, 1}, .tmax = 0}));
    EXPECT_TRUE(test.scene().intersect({.o = {0, 0, 0}, .d = {0, 0, 1}}));
}

TEST(OddRays, A16_NanLightSamplesAreDropped) {
    const TestScene test(sphere({0, 0, 0}, 1, ""));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Receiver from{.p = {3, 0, 0}, .n = {1, 0, 0}, .ns = {1, 0, 0}};
    for (const LightSample& to :
         {LightSample{.wi = Vector3(nan), .distance = infinity},
          LightSample{.wi = {1, 0, 0}, .distance = 1, .p = Vector3(nan)},
          LightSample{.wi = {1, 0, 0}, .distance = 1, .p = Vector3(infinity)}}) {
        EXPECT_TRUE(test.scene().occluded(from, to));
    }
}

/// In shadow rays and through scaled instances directions are not of unit length.
TEST(OddRays, A19_AnalyticShapesTakeDirectionsOfAnyLength) {
    const TestScene test(sphere({0, 0, 0}, 1, "") + shape("disk", translate({0, 0, 5}), ""));
    for (const float length : {1e-6f, 1e-2f, 1.0f, 100.0f, 1e6f}) {
        Ray ray{.o = {0, 0, -3}, .d = {0, 0, length}, .tmax = 1.9f / length};
        EXPECT_FALSE(test.scene().occluded(ray)) << length;
        ray.tmax = 2.1f / length;
        EXPECT_TRUE(test.scene().occluded(ray)) << length;
        ray = {.o = {0.9f, 0, 3}, .d = {0, 0, length}, .tmax = 2.1f / length};
        EXPECT_TRUE(test.scene().occluded(ray)) << length;
    }
}

/// From ten million times the size of the scene away.
TEST(OddRays, A18_FarOrigins) {
    const TestScene test(shape("cube", "", "") + sphere({5, 0, 0}, 1, ""));
    for (const float distance : {1e2f, 1e4f, 1e6f}) {
        for (const float x : {0.0f, 0.9f, 4.1f, 5.9f}) {
            const auto at = test.scene().intersect({.o = {x, 0, distance}, .d = {0, 0, -1}});
            ASSERT_TRUE(at) << distance << " " << x;
            EXPECT_NEAR(at->t, distance, 1.1f + 2e-7f * distance);
            EXPECT_NEAR(at->p.x, x, 1e-5);
        }
        EXPECT_FALSE(test.scene().intersect({.o = {2, 0, distance}, .d = {0, 0, -1}}));
    }
}

TEST(OddScenes, A23_FlatScenesAreHit) {
    for (const char* plane : {"", "<rotate y='1' angle='90'/>", "<rotate x='1' angle='90'/>"}) {
        for (const char* type : {"rectangle", "disk"}) {
            const TestScene test(shape(type, plane, "") + shape(type, scale(0.5) + plane, ""));
            const Vector3 n = test.scene().shapes().front()->normal_cone(0).first;
            Random random(6);
            for (int i = 0; i < 1000; ++i) {
                const Vector3 from = 2.0f * n + 0.3f * random.in_box(1);
                EXPECT_TRUE(test.scene().intersect({.o = from, .d = -n}));
            }
        }
    }
}

TEST(OddScenes, A9_A24_CoplanarFacesAndThreadsOfTheBuild) {
    std::string content;
    for (int i = 0; i < 20; ++i) {
        content += shape("rectangle", translate({0.1 * i, 0, 0}), "") +
                   shape("cube", translate({0.1 * i, 0, -1}), "");
    }
    const TestScene one(content), other(content);
    Random random(7);
    for (int i = 0; i < 20000; ++i) {
        const Vector3 o = 4.0f * random.direction(), target = random.in_box(1);
        const Ray ray{.o = o, .d = glm::normalize(target - o)};
        const auto a = one.scene().intersect(ray), b = other.scene().intersect(ray);
        ASSERT_EQ(a.has_value(), b.has_value());
        if (!a) continue;
        EXPECT_EQ(a->source, b->source);
        EXPECT_EQ(a->p, b->p);
    }
}

/// A ground of 10⁹ units under a camera at human height.
TEST(OddScenes, A2_A13_HugeGroundsAndPlanets) {
    const TestScene ground(shape("rectangle", scale(1e9), ""));
    const TestScene planet(sphere({0, 0, -6.4e6}, 6.4e6, ""));
    Random random(8);
    for (const TestScene* test : {&ground, &planet}) {
        for (int i = 0; i < 2000; ++i) {
            const Vector3 d = glm::normalize(random.in_box(1) - Vector3(0, 0, 1.2f));
            const Vector3 from(100 * random.number(), 0, 1.7f);
            const auto at = test->scene().intersect({.o = from, .d = d});
            ASSERT_TRUE(at);
            EXPECT_NEAR(at->p.z, 0, 0.02 + static_cast<double>(at->error));
            // It leaves the surface that it has hit.
            EXPECT_FALSE(test->scene().occluded(at->spawn_ray(Vector3(0, 0, 1))));
        }
    }
}

/// What shading needs is finite wherever a ray can meet degenerate triangles among good ones.
TEST(OddScenes, A10_DegenerateTrianglesAmongGoodOnes) {
    const TemporaryFolder folder;
    write_file(folder / "odd.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 1e-30 0 0\nv 0 1e-30 0\n"
               "f 1 2 3\nf 1 3 4\nf 1 1 1\nf 1 2 2\nf 1 2 5\nf 1 6 7\n");
    const TestScene test(path_integrator() + constant_light(1) +
                             mesh("odd.obj", "", diffuse(0.5) + area_light(1)) +
                             xml({.to_world = look({0.5, 0.5, 2}, {0.5, 0.5, 0}),
                                  .fov = 20,
                                  .width = 16,
                                  .height = 16}),
                         folder.path());
    EXPECT_EQ(test.scene().lights().size(), 7u);
    EXPECT_TRUE(agrees(pixel_statistics(test.render({.per_pixel = 256})), 1.5));
}

}  // namespace
}  // namespace lucerna
