// SPDX-License-Identifier: Apache-2.0
/// How long it takes to load: a mesh of a million triangles as PLY and as OBJ, and a scene of
/// 100,000 shapes. Processor seconds, and the memory of the process after each.
///
///     loading_benchmark
#include "core/description/xml_reader.h"
#include "core/render/statistics.h"
#include "core/scene/builder.h"
#include "tests/benchmarks/benchmark_scenes.h"
#include "tests/paths.h"

#include <fmt/format.h>
#include <fmt/os.h>

#include <cstdio>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

constexpr int side = 707;  // 2 · 707² = 999,698 triangles

struct Vertex {
    float x, y, z, u, v;
};

Vertex vertex(int i, int j) {
    const float u = static_cast<float>(i) / side, v = static_cast<float>(j) / side;
    return {u, v, 0.05f * std::sin(20 * u) * std::cos(17 * v), u, v};
}

void write_obj(const fs::path& path) {
    auto file = fmt::output_file(path.string());
    for (int j = 0; j <= side; ++j) {
        for (int i = 0; i <= side; ++i) {
            const Vertex p = vertex(i, j);
            file.print("v {:.6f} {:.6f} {:.6f}\nvt {:.6f} {:.6f}\n", p.x, p.y, p.z, p.u, p.v);
        }
    }
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const int a = j * (side + 1) + i + 1, b = a + side + 1;
            file.print("f {0}/{0} {1}/{1} {2}/{2}\nf {1}/{1} {3}/{3} {2}/{2}\n", a, a + 1, b,
                       b + 1);
        }
    }
}

void write_shapes(const fs::path& path) {
    auto file = fmt::output_file(path.string());
    file.print("<scene version=\"3.0.0\">\n<bsdf type=\"diffuse\" id=\"grey\"/>\n");
    for (int i = 0; i < 100'000; ++i) {
        file.print(
            "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"0.4\"/>"
            "<translate x=\"{}\" y=\"0\" z=\"{}\"/></transform><ref id=\"grey\"/></shape>\n",
            i % 317, i / 317);
    }
    file.print("</scene>\n");
}

void report(const char* what, double seconds) {
    fmt::print("{:<34} {:6.3f} s of processor time, {:6.0f} MB at most so far\n", what, seconds,
               static_cast<double>(peak_memory()) / 1e6);
}

/// Loads one shape, without building a scene around it.
void load_mesh(const char* type, const fs::path& path) {
    Diagnostics diagnostics;
    const Description description = read_scene_text(
        fmt::format("<scene version=\"3.0.0\"><shape type=\"{}\"><string name=\"filename\" "
                    "value=\"{}\"/></shape></scene>",
                    type, path.string()),
        "mesh", {}, diagnostics);
    diagnostics.throw_if_errors();
    Registry registry;
    std::vector<std::unique_ptr<Object>> objects;
    const double before = cpu_seconds();
    build_object(*description.root->children.at(0).element, description, registry, diagnostics,
                 objects);
    diagnostics.throw_if_errors();
    report(fmt::format("{}, 999,698 triangles", type).c_str(), cpu_seconds() - before);
}

void run(const fs::path& folder) {
    write_grid_ply(folder / "grid.ply", side);
    write_obj(folder / "grid.obj");
    write_shapes(folder / "shapes.xml");

    load_mesh("ply", folder / "grid.ply");
    load_mesh("obj", folder / "grid.obj");

    Diagnostics diagnostics;
    Registry registry;
    const double start = cpu_seconds();
    const Description description = read_scene(folder / "shapes.xml", {}, diagnostics);
    diagnostics.throw_if_errors();
    report("100,000 shapes, read", cpu_seconds() - start);
    const auto scene = build_scene(description, registry, diagnostics);
    report("100,000 shapes, read and built", cpu_seconds() - start);
}

}  // namespace

}  // namespace lucerna

int main() {
    try {
        const lucerna::TemporaryFolder folder;
        lucerna::run(folder.path());
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
