// SPDX-License-Identifier: Apache-2.0
/// bvh against the light BVH of pbrt: pbrt_light_bvh.txt lists probabilities that pbrt computed.
#include "plugins/light_samplers/lights/light_bvh.h"
#include "tests/paths.h"
#include "tests/prepared_sampler.h"
#include "tests/render_scene.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace lucerna {
namespace {

struct ListedReceiver {
    Receiver at;
    std::vector<double> pmf;  ///< of each light; zero if it is not listed
};

/// One scene of the list.
struct ListedScene {
    std::string lights;              ///< XML
    std::vector<TreeLight> bounded;  ///< with pbrt's rounded cones
    std::vector<ListedReceiver> receivers;
};

Vector3 read_vector(std::istream& in) {
    Vector3 v(0);
    in >> v.x >> v.y >> v.z;
    return v;
}

/// A parallelogram with a corner and two edges, as a rectangle.
std::string quad(Vector3 corner, Vector3 u, Vector3 v, double radiance) {
    const Vector3 c = corner + 0.5f * (u + v), n = glm::normalize(glm::cross(u, v));
    std::string rows;
    for (int i = 0; i < 3; ++i) {
        rows += fmt::format("{} {} {} {} ", 0.5f * u[i], 0.5f * v[i], n[i], c[i]);
    }
    return shape("rectangle", "<matrix value='" + rows + "0 0 0 1'/>", area_light(radiance));
}

LightCluster bounds_of_quad(Vector3 corner, Vector3 u, Vector3 v, double radiance, bool rounded) {
    LightCluster cluster;
    for (const Vector3 p : {corner, corner + u, corner + v, corner + u + v}) cluster.box.include(p);
    cluster.axis = glm::normalize(glm::cross(u, v));
    cluster.cos_normals = rounded ? 1 - 0x1p-24f : 1;
    cluster.cos_emission = -1e-5f;
    cluster.power = static_cast<float>(radiance) * glm::length(glm::cross(u, v)) * pi;
    return cluster;
}

std::vector<ListedScene> read_list() {
    std::ifstream file(tests_folder() / "plugins/pbrt_light_bvh.txt");
    std::vector<ListedScene> scenes;
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        std::string word;
        in >> word;
        if (word == "scene") {
            scenes.emplace_back();
        } else if (word == "light") {
            const Vector3 corner = read_vector(in), u = read_vector(in), v = read_vector(in);
            double radiance = 0;
            in >> radiance;
            scenes.back().lights += quad(corner, u, v, radiance);
            bool rounded = false;
            in >> rounded;
            scenes.back().bounded.push_back(
                {.cluster = bounds_of_quad(corner, u, v, radiance, rounded),
                 .light = static_cast<std::uint32_t>(scenes.back().bounded.size())});
        } else if (word == "receiver") {
            ListedReceiver receiver{.at = {},
                                    .pmf = std::vector<double>(scenes.back().bounded.size())};
            receiver.at.p = read_vector(in);
            receiver.at.n = receiver.at.ns = glm::normalize(read_vector(in));
            scenes.back().receivers.push_back(receiver);
        } else if (word != "#") {
            std::istringstream items(line);
            for (std::size_t light = 0; items >> light;) {
                items >> scenes.back().receivers.back().pmf.at(light);
            }
        }
    }
    return scenes;
}

/// Calls `check(probability, pbrt's)` for all lights at all receivers.
template <typename Probability, typename Check>
void compare(const ListedScene& listed, const Probability& pmf, const Check& check) {
    for (const ListedReceiver& receiver : listed.receivers) {
        for (std::uint32_t i = 0; i < listed.bounded.size(); ++i) {
            SCOPED_TRACE(i);
            check(static_cast<double>(pmf(receiver.at, i)), receiver.pmf[i]);
        }
    }
}

TEST(LightBVH, has_the_probabilities_of_pbrt_for_its_bounds_of_lights) {
    const std::vector<ListedScene> scenes = read_list();
    ASSERT_EQ(scenes.size(), 2u);
    for (const ListedScene& listed : scenes) {
        const LightBVH tree(listed.bounded, listed.bounded.size(), Workers(1));
        int count = 0;
        const auto pmf = [&](const Receiver& at, std::uint32_t light) {
            return tree.pmf(at, light, 1);
        };
        compare(listed, pmf, [&](double p, double expected) {
            EXPECT_NEAR(p, expected, expected > 0 ? 1e-3 * expected : 1e-5);
            count += expected > 0;
        });
        EXPECT_GT(count, 400);
    }
}

TEST(LightBVH, has_the_probabilities_of_pbrt) {
    for (const ListedScene& listed : read_list()) {
        const TestScene test(listed.lights);
        const PreparedSampler sampler(light_sampler("bvh"), test.scene());
        int near = 0, count = 0;
        const auto drawn = [&](const Receiver& at, std::uint32_t light) {
            return pmf(*sampler, at, light);
        };
        compare(listed, drawn, [&](double p, double expected) {
            // Here the cone of a flat light has no width: pbrt's, if rounded, has 0.02 degrees.
            EXPECT_NEAR(p, expected, expected > 0 ? 0.01 * expected : 1e-5);
            near += expected > 0 && std::abs(p / expected - 1) < 1e-3;
            count += expected > 0;
        });
        EXPECT_GT(count, 400);
        EXPECT_GT(near, 0.98 * count);
    }
}

}  // namespace
}  // namespace lucerna
