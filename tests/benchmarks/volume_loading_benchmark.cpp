// SPDX-License-Identifier: Apache-2.0
/// How long it takes to load a ball of fog of 256³ voxels of one float each, as `.vol`, `.nvdb` and
/// `.vdb`: seconds, the largest memory of the process beyond what it had before, and that of the
/// process that reads `.vdb` files.
///
///     volume_loading_benchmark
#include "core/description/xml_reader.h"
#include "core/interfaces/volume.h"
#include "core/plugin/registry.h"
#include "core/scene/builder.h"
#include "tests/paths.h"
#include "tests/vol_writer.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/GridBuilder.h>
#include <nanovdb/util/IO.h>
#include <openvdb/openvdb.h>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

constexpr int side = 256;
constexpr double data = 4.0 * side * side * side;  // [bytes]

/// Dense in all voxels, so that the box is that of the grid; noise, which compresses badly.
float fog(int x, int y, int z) {
    const auto u = [](int i) { return static_cast<std::uint32_t>(i); };
    std::uint32_t h = u(x) * 374761393u + u(y) * 668265263u + u(z) * 2147483647u;
    h = (h ^ (h >> 13)) * 1274126177u;
    const auto centred = [](int i) { return (static_cast<float>(i) + 0.5f) / side - 0.5f; };
    const float r2 = centred(x) * centred(x) + centred(y) * centred(y) + centred(z) * centred(z);
    return std::exp(-8 * r2) * (0.5f + 0.5f * static_cast<float>(h >> 8) * 0x1p-24f);
}

void write_vol(const fs::path& path) {
    std::vector<float> numbers;
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) numbers.push_back(fog(x, y, z));
        }
    }
    write_bytes(path, vol_bytes({.resolution = {side, side, side}}, numbers));
}

void write_nanovdb(const fs::path& path, nanovdb::io::Codec codec) {
    nanovdb::GridBuilder<float> builder(0.0f);
    builder.setGridClass(nanovdb::GridClass::FogVolume);
    builder([](const nanovdb::Coord& c) { return fog(c[0], c[1], c[2]); },
            nanovdb::CoordBBox(nanovdb::Coord(0), nanovdb::Coord(side - 1)));
    const auto handle = builder.getHandle(1.0 / side, nanovdb::Vec3d(0), "density");
    nanovdb::io::writeGrid(path.string(), handle, codec);
}

void write_openvdb(const fs::path& path, std::uint32_t compression) {
    openvdb::initialize();
    const auto grid = openvdb::FloatGrid::create();
    auto accessor = grid->getAccessor();
    for (int z = 0; z < side; ++z) {
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) accessor.setValue({x, y, z}, fog(x, y, z));
        }
    }
    grid->setName("density");
    grid->setGridClass(openvdb::GRID_FOG_VOLUME);
    openvdb::io::File file(path.string());
    file.setCompression(compression);
    file.write({grid});
    file.close();
}

/// A line of /proc/self/status [bytes].
double memory(const char* name) {
    std::ifstream file("/proc/self/status");
    std::string word;
    double kilobytes = 0;
    while (file >> word) {
        if (word == name) file >> kilobytes;
    }
    return 1024 * kilobytes;
}

void load(const char* type, const fs::path& path, const char* what) {
    Diagnostics diagnostics;
    const Description description = read_scene_text(
        fmt::format("<scene version=\"3.0.0\"><volume type=\"{}\"><string name=\"filename\" "
                    "value=\"{}\"/></volume></scene>",
                    type, path.string()),
        "volume", {}, diagnostics);
    diagnostics.throw_if_errors();
    Registry registry;
    std::vector<std::unique_ptr<Object>> objects;
    std::ofstream("/proc/self/clear_refs") << "5";  // the largest so far is now what there is
    const double before = memory("VmRSS:");
    const auto start = std::chrono::steady_clock::now();
    build_object(*description.root->children.at(0).element, description, registry, diagnostics,
                 objects);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    diagnostics.throw_if_errors();
    fmt::print("| {} {} | {:.0f} | {:.2f} | {:.2f} |\n", type, what,
               static_cast<double>(fs::file_size(path)) / 1e6, seconds.count(),
               (memory("VmHWM:") - before) / data);
}

void run(const fs::path& folder) {
    using openvdb::io::COMPRESS_ACTIVE_MASK, openvdb::io::COMPRESS_BLOSC, openvdb::io::COMPRESS_ZIP;
    write_vol(folder / "a.vol");
    write_nanovdb(folder / "a.nvdb", nanovdb::io::Codec::NONE);
    write_nanovdb(folder / "blosc.nvdb", nanovdb::io::Codec::BLOSC);
    write_nanovdb(folder / "zip.nvdb", nanovdb::io::Codec::ZIP);
    write_openvdb(folder / "a.vdb", COMPRESS_ACTIVE_MASK);
    write_openvdb(folder / "blosc.vdb", COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK);
    write_openvdb(folder / "zip.vdb", COMPRESS_ZIP | COMPRESS_ACTIVE_MASK);
    fmt::print("| volume | file [MB] | s | memory / data |\n|---|---|---|---|\n");
    for (int round = 0; round < 3; ++round) {
        load("gridvolume", folder / "a.vol", "");
        load("nanovdb", folder / "a.nvdb", "");
        load("nanovdb", folder / "blosc.nvdb", "blosc");
        load("nanovdb", folder / "zip.nvdb", "zip");
        load("openvdb", folder / "a.vdb", "");
        load("openvdb", folder / "blosc.vdb", "blosc");
        load("openvdb", folder / "zip.vdb", "zip");
    }
    rusage children{};
    getrusage(RUSAGE_CHILDREN, &children);
    fmt::print("The process that reads .vdb files: {:.2f} of the data\n",
               1024.0 * static_cast<double>(children.ru_maxrss) / data);
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
