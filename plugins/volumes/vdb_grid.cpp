// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/vdb_grid.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna {

namespace {

[[noreturn]] void fail_memory(const VoxelBox& active, int channels, const std::string& what) {
    const glm::i64vec3 n = glm::i64vec3(active.max) - glm::i64vec3(active.min) + std::int64_t{1};
    throw Error(
        fmt::format("{}: the box of its active voxels, {} × {} × {}, takes {} bytes for each of "
                    "them, more than this machine has",
                    what, n.x, n.y, n.z, sizeof(float) * static_cast<std::size_t>(channels)));
}

}  // namespace

std::size_t choose_grid(const std::vector<std::string>& names, const std::string& wanted,
                        const std::string& file) {
    if (names.empty()) throw Error(file + ": it holds no grids");
    if (wanted.empty() && names.size() == 1) return 0;
    const std::string name = wanted.empty() ? "density" : wanted;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    std::vector<std::string> quoted;
    for (const std::string& each : names) quoted.push_back(quote(each));
    const std::string held = "it holds " + join(quoted);
    if (wanted.empty()) {
        throw Error(fmt::format("{}: {}; say which one is meant with \"grid\"", file, held));
    }
    throw Error(fmt::format("{}: there is no grid {}; {}{}", file, quote(wanted), held,
                            did_you_mean(wanted, names)));
}

void check_class(const std::string& what, const std::string& grid_class) {
    if (grid_class == "fog volume" || grid_class == "unknown") return;
    if (grid_class == "level set") {
        throw Error(what +
                    " is a level set, of distances to a surface; a volume needs a fog volume, of "
                    "densities");
    }
    throw Error(
        fmt::format("{} is of the class \"{}\"; a volume needs a fog volume", what, grid_class));
}

VoxelBox dense_box(const VoxelBox& active, int channels, const std::string& what,
                   std::uint64_t memory) {
    const bool none = glm::any(glm::greaterThan(active.min, active.max));
    const VoxelBox box = none ? VoxelBox{Vector3i(0), Vector3i(0)} : active;
    constexpr int limit = 1 << 30;
    if (glm::any(glm::lessThan(box.min, Vector3i(-limit))) ||
        glm::any(glm::greaterThan(box.max, Vector3i(limit)))) {
        throw Error(fmt::format("{}: it has active voxels at indices beyond ±{}", what, limit));
    }
    const glm::i64vec3 n = glm::i64vec3(box.max) - glm::i64vec3(box.min) + std::int64_t{3};
    const auto bytes_each = sizeof(float) * static_cast<std::uint64_t>(channels);
    std::uint64_t possible = memory / bytes_each;
    for (int k = 0; k < 3; ++k) possible /= static_cast<std::uint64_t>(n[k]);
    if (possible == 0 || glm::any(glm::greaterThan(n, glm::i64vec3(limit)))) {
        fail_memory(box, channels, what);
    }
    return {box.min - 1, box.max + 1};
}

VdbGrid dense_grid(const VoxelBox& active, int channels, const Transform& world_from_index,
                   const std::string& what, std::uint64_t memory) {
    const VoxelBox box = dense_box(active, channels, what, memory);
    VdbGrid grid;
    try {
        grid.voxels = VoxelGrid(box.max - box.min + 1, channels, VoxelGrid::Encoding::float32);
    } catch (const std::bad_alloc&) {
        fail_memory({box.min + 1, box.max - 1}, channels, what);
    }
    grid.first = box.min;
    grid.world_from_index = world_from_index;
    return grid;
}

Transform index_transform(const Matrix4d& matrix, const std::string& what) {
    try {
        return Transform(matrix);
    } catch (const std::invalid_argument&) {
        throw Error(what + ": its transform from indices to the world has no inverse");
    }
}

}  // namespace lucerna
