// SPDX-License-Identifier: Apache-2.0
/// bvh against the light BVH of pbrt: pbrt_light_bvh.txt lists probabilities that pbrt computed.
#include "core/interfaces/light_sampler.h"
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
    std::string lights;
    std::size_t light_count = 0;
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
            ++scenes.back().light_count;
        } else if (word == "receiver") {
            ListedReceiver receiver{.at = {},
                                    .pmf = std::vector<double>(scenes.back().light_count)};
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

TEST(LightBVH, has_the_probabilities_of_pbrt) {
    const std::vector<ListedScene> scenes = read_list();
    ASSERT_EQ(scenes.size(), 2u);
    for (const ListedScene& listed : scenes) {
        const TestScene test(listed.lights);
        const PreparedSampler sampler(light_sampler("bvh"), test.scene());
        int near = 0, count = 0;
        for (const ListedReceiver& receiver : listed.receivers) {
            for (std::uint32_t i = 0; i < listed.light_count; ++i) {
                const double expected = receiver.pmf[i];
                const auto p = static_cast<double>(sampler->pmf(receiver.at, i));
                if (expected == 0) {
                    EXPECT_LT(p, 1e-4);
                    continue;
                }
                // The list has six digits and pbrt rounds bounds to a grid: a number at the edge of
                // a step can fall to its other side.
                EXPECT_NEAR(p / expected, 1, 0.01) << "light " << i;
                near += std::abs(p / expected - 1) < 1e-3;
                ++count;
            }
        }
        EXPECT_GT(count, 400);
        EXPECT_GT(near, 0.98 * count);
    }
}

}  // namespace
}  // namespace lucerna
