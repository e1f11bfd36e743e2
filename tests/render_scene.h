// SPDX-License-Identifier: Apache-2.0
/// Whole scenes from text, renders of them through the library, and what tests ask of the images.
#pragma once

#include "core/plugin/registry.h"
#include "core/render/render_job.h"
#include "core/scene/builder.h"
#include "tests/statistics.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// How a test renders. The image depends on the first two only.
struct Samples {
    std::uint64_t per_pixel = 16;
    std::uint64_t seed = 0;
    int threads = 0;  ///< 0: all
};

/// A scene from what stands between `<scene>` and `</scene>`.
class TestScene {
public:
    /// Files are looked for in `folder`. Throws SceneError.
    explicit TestScene(const std::string& content, const std::filesystem::path& folder = ".");
    /// The same with plugins that `registry` has been given.
    TestScene(const std::string& content, Registry registry,
              const std::filesystem::path& folder = ".");

    const Scene& scene() const { return *scene_; }
    Registry& registry() { return registry_; }
    /// What the author was told.
    std::string warnings() const;

    FilmState render(const Samples& samples) const;

private:
    Registry registry_;
    Diagnostics diagnostics_;
    std::unique_ptr<Scene> scene_;
};

/// A camera for statistics: few pixels, box filter, independent random numbers.
struct TestCamera {
    std::string to_world;  ///< steps of a transform
    double fov = 0.01;     ///< [degrees]; the default sees one point
    int width = 8, height = 8;
    double near_clip = 1e-3, far_clip = 1e6;
    std::string sampler = "independent";
    std::string rfilter = "box";
    std::string type = "perspective";
    std::string inside = "";  ///< further parameters
};
std::string xml(const TestCamera& camera);
/// `<lookat …/>`, with an up vector that fits.
std::string look(Vector3d from, Vector3d at);
/// A camera at a point above a surface with the normal `n`, which sees nothing else than `p`.
std::string probe(Vector3d p, Vector3d n, double distance = 0.05);

std::string translate(Vector3d by);
std::string scale(double factor);
/// A shape with steps of its transform and anything else inside.
std::string shape(const std::string& type, const std::string& to_world, const std::string& inside);
std::string sphere(Vector3d center, double radius, const std::string& inside);
std::string diffuse(double reflectance);
std::string area_light(double radiance);
std::string constant_light(double radiance);
std::string point_light(Vector3d position, double intensity);
/// Unless `inside` says more, pixels share no paths and are independent of each other, and each
/// vertex takes one pass of light samples, which follow no specular chains.
std::string path_integrator(const std::string& inside = "");
std::string direct_integrator(const std::string& inside = "");
std::string integer(const std::string& name, std::int64_t value);
std::string number(const std::string& name, double value);
std::string boolean(const std::string& name, bool value);
std::string text_of(Vector3d v);

/// The unit sphere as a closed mesh of 4 · n² triangles and two rows at its poles, in OBJ format;
/// with normals of the sphere at its vertices if `smooth`.
std::string sphere_obj(int n, bool smooth);
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// All numbers of the image, for comparisons of bits.
std::vector<double> numbers_of(const FilmState& film);
/// Over the pixels, each the mean of its samples; pixels are independent of each other.
RunningStatistics pixel_statistics(const FilmState& film, std::size_t channel = 0);
/// Over independent images of a scene, each the mean of its pixels. No sample may be dropped.
RunningStatistics image_means(const std::string& content, std::uint64_t samples, int images = 12);
/// Smallest and largest mean of a pixel in the channel.
Interval pixel_range(const FilmState& film, std::size_t channel = 0);

/// The mean is within 4 standard errors of the reference, which are at most `precision` times it.
/// Floats are granted 2·10⁻⁵ of it.
testing::AssertionResult agrees(const RunningStatistics& x, double reference,
                                double precision = 0.002);
/// The same for two means.
testing::AssertionResult agree(const RunningStatistics& a, const RunningStatistics& b,
                               double precision = 0.002);
/// All pixels are within a relative tolerance of the value, and no sample was dropped.
testing::AssertionResult is_constant(const FilmState& film, double value, double tolerance = 2e-5);

/// Irradiance that a polygon of radiance 1 causes at p with the normal n (Lambert 1760, after
/// clipping to the horizon).
double polygon_irradiance(std::vector<Vector3d> vertices, Vector3d p, Vector3d n);

/// An integrator `make(content)` that samples at each point as many lights as the scene `text` has,
/// stratified over all of them.
template <typename Make>
std::string with_all_lights(const Make& make, const std::string& text,
                            const std::filesystem::path& folder = ".") {
    const auto lights = static_cast<int>(TestScene(text, folder).scene().lights().size());
    return make("<light_sampler type='uniform'/>" + integer("emitter_samples", lights));
}

}  // namespace lucerna
