// SPDX-License-Identifier: Apache-2.0
/// Scenes with emitters, and the light that arrives from them: for their tests.
#pragma once

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

constexpr double pi_d = std::numbers::pi;

inline std::string emitter(const std::string& type, const std::string& body = "") {
    return fmt::format("<emitter type='{}'>{}</emitter>", type, body);
}
inline std::string shape(const std::string& type, const std::string& body) {
    return fmt::format("<shape type='{}'>{}</shape>", type, body);
}
inline std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}
inline std::string rgb(const std::string& name, const std::string& value) {
    return fmt::format("<rgb name='{}' value='{}'/>", name, value);
}
const std::string glow = emitter("area", rgb("radiance", "1"));
const std::string ball = shape("sphere", "");
const std::string facing_down = "<rotate x='1' angle='180'/>";

inline void write_map(const std::filesystem::path& path, int width, int height,
                      const std::function<Color(int, int)>& color) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.set_rgb(x, y, color(x, y));
    }
    ImageFile file;
    add_layer(file, image);
    write_exr(path, file);
}

inline Receiver receiver(Vector3 p, Vector3 n, Sides sides = Sides::front) {
    return {.p = p, .n = glm::normalize(n), .ns = glm::normalize(n), .sides = sides};
}

/// One draw of one light, each light with the same probability.
struct Draw {
    std::uint32_t light;
    std::optional<LightSample> sample;
};
inline Draw draw(const Scene& scene, const Receiver& from, Rng& rng) {
    const auto n = static_cast<std::uint32_t>(scene.lights().size());
    const std::uint32_t light = rng.next_uint() % n;
    const Vector2 u = rng.next_float2();
    const Light& chosen = scene.lights()[light];
    return {light, chosen.emitter->sample_li(chosen, from, u)};
}

/// Lights in proportion to their power; all alike if none has any.
inline DiscreteDistribution by_power(const Scene& scene) {
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
inline RunningStatistics irradiance(const Scene& scene, const Receiver& at, int samples = 100000,
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

/// Functions that a density must weight rightly: moments of the direction.
constexpr std::size_t moment_count = 5;
inline std::array<double, moment_count> moments(Vector3 w) {
    const Vector3d d(w);
    return {1, 1 + d.x, 1 + d.y, 1 + d.z, sqr(d.x - d.z)};
}

}  // namespace lucerna
