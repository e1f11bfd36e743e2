// SPDX-License-Identifier: Apache-2.0
/// The scene of the speed benchmarks, and how they time.
#pragma once

#include "core/render/render_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

namespace lucerna {

/// 40 × 40 diffuse blocks (19,202 triangles with the plane) under 64 rectangular lamps, seen from
/// above; paths of depth 5.
inline std::string diffuse_city() {
    std::string text = R"(<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="6"/><integer name="rr_depth" value="100"/>
</integrator>
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
