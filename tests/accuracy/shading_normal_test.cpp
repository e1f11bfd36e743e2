// SPDX-License-Identifier: Apache-2.0
/// Interpolated normals mean the same whichever end of a path they are met from.
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

struct Pixels {
    std::vector<double> mean, variance;  ///< of the mean
};

/// Over independent images.
Pixels pixels_of(const TestScene& scene, std::uint64_t samples, std::uint64_t first_seed) {
    std::vector<RunningStatistics> pixels;
    for (std::uint64_t i = 0; i < 32; ++i) {
        const FilmState film = scene.render({.per_pixel = samples, .seed = first_seed + i});
        EXPECT_EQ(film.dropped_samples(), 0u);
        pixels.resize(film.pixel_count());
        for (std::size_t p = 0; p < pixels.size(); ++p) pixels[p].add(film.mean(p, 1));
    }
    Pixels result;
    for (const RunningStatistics& p : pixels) {
        result.mean.push_back(p.mean());
        result.variance.push_back(sqr(p.standard_error()));
    }
    return result;
}

/// Light that goes from the lamp to the camera and from the camera to the lamp scatters alike, at
/// the silhouette of a coarse ball, too. With max_depth 3 it scatters twice: at the floor, or at
/// the ball, the previous vertex of a path is the camera for one and the lamp for the other.
TEST(ShadingNormals, G11_D10_P1_CoarseSmoothMeshesLookAlikeFromBothEnds) {
    const TemporaryFolder folder;
    write_file(folder / "ball.obj", sphere_obj(2, true));
    const std::string content =
        xml({.to_world = look({2.5, 1.5, 3.5}, {0, -0.3, 0}), .fov = 32, .width = 8, .height = 8}) +
        shape("rectangle", scale(3) + look({0, -1, 0}, {0, 0, 0}), diffuse(0.5)) +
        "<shape type='obj'><string name='filename' value='ball.obj'/>" + diffuse(0.7) + "</shape>" +
        point_light({2, 2.5, 1}, 25);
    const std::string depth = integer("max_depth", 3);
    const Pixels path =
        pixels_of(TestScene(path_integrator(depth) + content, folder.path()), 128, 0);
    const Pixels particles = pixels_of(
        TestScene("<integrator type='ptracer'>" + depth + "</integrator>" + content, folder.path()),
        1024, 1000);
    EXPECT_TRUE(image_matches(particles.mean, particles.variance, path.mean, path.variance));
}

}  // namespace
}  // namespace lucerna
