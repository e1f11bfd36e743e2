// SPDX-License-Identifier: Apache-2.0
/// The scenes of the speed benchmarks, and how they time.
#pragma once

#include "core/render/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lucerna {

/// 40 × 40 diffuse blocks (19,202 triangles with the plane) under 64 rectangular lamps, seen from
/// above; paths of depth 5.
inline std::string diffuse_city() {
    std::string text = R"(<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/><integer name="rr_depth" value="100"/>
<light_sampler type="power"/></integrator>
<sensor type="perspective"><float name="fov" value="50"/>
<transform name="to_world"><lookat origin="0,45,-60" target="0,0,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="180"/>
<rfilter type="box"/></film></sensor>
<bsdf type="diffuse" id="stone"><rgb name="reflectance" value="0.6"/></bsdf>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
<scale value="60"/></transform><ref id="stone"/></shape>
)";
    for (int i = 0; i < 1600; ++i) {
        const int x = i % 40, z = i / 40;
        const double height = 0.6 + ((i * 7919) % 97) / 97.0 * 4;
        text += fmt::format(
            R"(<shape type="cube"><transform name="to_world"><scale x="0.7" y="{:.3f}" z="0.7"/>)"
            R"(<translate x="{:.2f}" y="{:.3f}" z="{:.2f}"/></transform><ref id="stone"/></shape>)"
            "\n",
            height, 2.4 * (x - 20) + 1.2, height, 2.4 * (z - 20) + 1.2);
    }
    for (int i = 0; i < 64; ++i) {
        text += fmt::format(
            R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>)"
            R"(<translate x="{:.2f}" y="12" z="{:.2f}"/></transform><emitter type="area">)"
            R"(<rgb name="radiance" value="20"/></emitter></shape>)"
            "\n",
            12.0 * (i % 8) - 42, 12.0 * (i / 8) - 42);
    }
    return text + "</scene>\n";
}

/// A wavy unit square of 2 · side² triangles as a binary PLY file.
inline void write_grid_ply(const std::filesystem::path& path, int side) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << (side + 1) * (side + 1)
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float u\n"
            "property float v\nelement face "
         << 2 * side * side << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (int j = 0; j <= side; ++j) {
        for (int i = 0; i <= side; ++i) {
            const float u = static_cast<float>(i) / static_cast<float>(side);
            const float v = static_cast<float>(j) / static_cast<float>(side);
            const float vertex[5] = {u, v, 0.05f * std::sin(20 * u) * std::cos(17 * v), u, v};
            file.write(reinterpret_cast<const char*>(vertex), sizeof vertex);
        }
    }
    const auto face = [&](int a, int b, int c) {
        char bytes[13] = {3};
        const int indices[3] = {a, b, c};
        std::memcpy(bytes + 1, indices, sizeof indices);
        file.write(bytes, sizeof bytes);
    };
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const int a = j * (side + 1) + i, b = a + side + 1;
            face(a, a + 1, b);
            face(a + 1, b + 1, b);
        }
    }
}

/// A closed diffuse room whose floor is a wavy mesh of a million triangles, under 64 lamps; every
/// path has its full depth of 5. The mesh is written into `folder`.
inline std::string diffuse_room(const std::filesystem::path& folder) {
    write_grid_ply(folder / "floor.ply", 707);
    std::string text = fmt::format(R"(<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/><integer name="rr_depth" value="100"/>
<light_sampler type="power"/></integrator>
<sensor type="perspective"><float name="fov" value="70"/>
<transform name="to_world"><lookat origin="0,4,-9.5" target="0,1,0" up="0,1,0"/></transform>
<film type="hdrfilm"><integer name="width" value="320"/><integer name="height" value="180"/>
<rfilter type="box"/></film></sensor>
<bsdf type="diffuse" id="stone"><rgb name="reflectance" value="0.6"/></bsdf>
<shape type="cube"><boolean name="flip_normals" value="true"/><transform name="to_world">
<scale x="10" y="4" z="10"/><translate y="3"/></transform><ref id="stone"/></shape>
<shape type="ply"><string name="filename" value="{}"/><transform name="to_world">
<translate x="-0.5" y="-0.5"/><rotate x="1" angle="-90"/><scale x="20" y="10" z="20"/></transform>
<ref id="stone"/></shape>
)",
                                   (folder / "floor.ply").string());
    for (int i = 0; i < 64; ++i) {
        text += fmt::format(
            R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>)"
            R"(<scale value="0.2"/><translate x="{:.2f}" y="6.9" z="{:.2f}"/></transform>)"
            R"(<emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>)"
            "\n",
            2.4 * (i % 8) - 8.4, 2.4 * (i / 8) - 8.4);
    }
    return text + "</scene>\n";
}

using BenchmarkClock = std::chrono::steady_clock;

inline double seconds_since(BenchmarkClock::time_point start) {
    return std::chrono::duration<double>(BenchmarkClock::now() - start).count();
}

/// Seconds to render `samples` samples of every pixel.
inline double render_seconds(const Scene& scene, int threads, std::uint64_t samples) {
    RenderOptions options;
    options.budget.samples = samples;
    options.threads = threads;
    RenderJob job(scene, options, FilmState(film_layout(scene)));
    const auto start = BenchmarkClock::now();
    scene.integrator().render(job);
    return seconds_since(start);
}

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace lucerna
