// SPDX-License-Identifier: Apache-2.0
/// What it costs that plugins are shared libraries: renders the same scene with plugins opened by
/// dlopen, and with the same sources linked into this program.
///
///     plugin_boundary_benchmark [rounds]
#include "core/description/xml_reader.h"
#include "core/scene/builder.h"
#include "tests/benchmarks/benchmark_scenes.h"

#include <cstdio>

// The plugins' sources, each compiled with its `plugin` renamed: see CMakeLists.txt.
#define LUCERNA_LINKED_PLUGIN(folder, name) \
    extern "C" const lucerna::PluginInfo plugin_##folder##_##name;
#include "linked_plugins.inc"
#undef LUCERNA_LINKED_PLUGIN

namespace lucerna {

namespace {

void run(int rounds) {
    Diagnostics diagnostics;
    const Description description = read_scene_text(diffuse_city(), "city", {}, diagnostics);
    diagnostics.throw_if_errors();

    Registry libraries;
    Registry linked;
#define LUCERNA_LINKED_PLUGIN(folder, name) linked.add(#name, plugin_##folder##_##name);
#include "linked_plugins.inc"
#undef LUCERNA_LINKED_PLUGIN
    const auto with_libraries = build_scene(description, libraries, diagnostics);
    const auto with_linked = build_scene(description, linked, diagnostics);

    constexpr std::uint64_t samples = 8;
    render_seconds(*with_libraries, 1, 1);
    render_seconds(*with_linked, 1, 1);
    std::vector<double> ratios;
    for (int i = 0; i < rounds; ++i) {
        const double opened = render_seconds(*with_libraries, 1, samples);
        ratios.push_back(opened / render_seconds(*with_linked, 1, samples));
    }
    fmt::print("time with libraries / time linked: {:.3f} (median of {})\n", median(ratios),
               rounds);
}

}  // namespace

}  // namespace lucerna

int main(int argc, char** argv) {
    try {
        lucerna::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 7);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
