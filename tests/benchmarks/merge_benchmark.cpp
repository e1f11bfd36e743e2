// SPDX-License-Identifier: Apache-2.0
/// What it takes to write the states of parts of 1920 × 1080 pixels and to merge them.
///
///     merge_benchmark [PARTS [FOLDER [WIDTH HEIGHT]]]
///
/// Every pixel has 16 samples of random light, spread by a Gaussian filter. The files of 64 parts
/// take 10 GB. They stay in FOLDER, if it is given, for `lucerna merge FOLDER/*.exr -o PICTURE`.
#include "core/base/atomic_file.h"
#include "core/base/parallel.h"
#include "core/math/sequences.h"
#include "core/render/merge.h"
#include "core/render/statistics.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::uint64_t samples = 16;

class GaussianFilter final : public RFilter {
public:
    float radius() const override { return 2; }
    float evaluate(float x) const override {
        return std::max(std::exp(-2 * x * x) - std::exp(-8.0f), 0.0f);
    }
};

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Films differ in where their samples begin only.
FilmState random_film(Vector2i size, std::uint64_t first_sample) {
    const ReconstructionFilter filter{GaussianFilter()};
    FilmState film({.full_size = size,
                    .crop = {.offset = Vector2i(0), .size = size},
                    .layers = {},
                    .reach = filter.reach(),
                    .negative_weight = filter.negative_weight(),
                    .noise_correlation = filter.noise_correlation()},
                   first_sample);
    constexpr int rows = 16;
    for (int y = 0; y < size.y; y += rows) {
        const CropWindow window = {.offset = {0, y}, .size = {size.x, std::min(rows, size.y - y)}};
        FilmTile tile(filter, window, 0, false);
        Rng rng(static_cast<std::uint64_t>(y));
        for (int i = 0; i < window.size.x * window.size.y; ++i) {
            for (std::uint64_t k = 0; k < samples; ++k) {
                FilmSample sample;
                sample.pixel = {i % size.x, i / size.x};
                sample.offset = rng.next_float2();
                sample.half = static_cast<int>(k & 1);
                const float u = rng.next_float();
                sample.value.radiance = Color(u * u, u, rng.next_float()) / (u + 0.01f);
                tile.add(sample);
            }
        }
        film.add(tile, 0, size.y);
    }
    return film;
}

void measure(std::uint64_t parts, const fs::path& folder, bool keep, Vector2i size) {
    fs::create_directories(folder);
    std::vector<fs::path> files;
    double writing = 0, cpu_of_writing = 0;
    std::uintmax_t bytes = 0;
    {
        const FilmState film = random_film(size, 0);
        PartRecord part = {.all_samples = parts * samples, .parts = 1, .film = "hdrfilm"};
        for (std::uint64_t k = 0; k < parts; ++k) {
            files.push_back(folder / fmt::format("{}.exr", k + 1));
            part.samples = SampleRanges({.begin = k * samples, .end = (k + 1) * samples});
            part.planned = part.samples;
            const Clock::time_point start = Clock::now();
            const double cpu = cpu_seconds();
            write_state(files.back(), film, {}, 1, part);
            writing += seconds_since(start);
            cpu_of_writing += cpu_seconds() - cpu;
            bytes += fs::file_size(files.back());
        }
    }
    const auto count = static_cast<double>(parts);
    fmt::print(
        "{} parts of {} x {} pixels: {:.0f} MB each, written in {:.2f} s each ({:.2f} s of "
        "processor time)\n",
        parts, size.x, size.y, static_cast<double>(bytes) / count * 1e-6, writing / count,
        cpu_of_writing / count);
    const std::uint64_t memory_before = peak_memory();
    const double cpu_before = cpu_seconds();
    const Clock::time_point start = Clock::now();
    const RenderState merged = merge_states(files);
    const double merging = seconds_since(start);
    fmt::print("merged in {:.2f} s, {:.0f} ms for each part ({:.2f} s of processor time): {} spp\n",
               merging, 1000 * merging / count, cpu_seconds() - cpu_before,
               merged.film.complete_samples());
    fmt::print("peak memory: {} MB before merging (writing), {} MB after\n",
               memory_before / 1000000, peak_memory() / 1000000);
    if (!keep) fs::remove_all(folder);
}

}  // namespace
}  // namespace lucerna

int main(int argc, char** argv) {
    const auto number = [&](int i, long otherwise) {
        return argc > i ? std::strtol(argv[i], nullptr, 10) : otherwise;
    };
    const std::filesystem::path folder =
        argc > 2 ? argv[2] : std::filesystem::temp_directory_path() / "lucerna_parts";
    lucerna::measure(static_cast<std::uint64_t>(number(1, 64)), folder, argc > 2,
                     {static_cast<int>(number(3, 1920)), static_cast<int>(number(4, 1080))});
}
