// SPDX-License-Identifier: Apache-2.0
/// The figures of a render: what it took and how good it is.
#pragma once

#include "core/base/json.h"
#include "core/render/error_estimate.h"
#include "core/scene/ray_statistics.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

class FilmState;

struct RenderFigures {
    double load_seconds = 0;     ///< reading the scene file
    double build_seconds = 0;    ///< constructing and preparing all objects
    double render_seconds = 0;   ///< of this run
    double cpu_seconds = 0;      ///< of the process so far
    double earlier_seconds = 0;  ///< rendering before this run, if it was resumed
    std::uint64_t samples = 0;   ///< per pixel, of all runs
    RayStatistics rays;          ///< of this run
    std::optional<ErrorEstimate> error;
    std::optional<double> error_asked;  ///< RenderBudget::error
    std::uint64_t dropped_samples = 0;  ///< not finite
    std::string first_dropped_pixel;    ///< "x, y", or empty
    std::uint64_t empty_pixels = 0;
    std::uint64_t peak_memory = 0;  ///< of the process [bytes]
    std::uint64_t accelerator_bytes = 0;
    std::uint64_t light_sampler_bytes = 0;  ///< of its tables; 0 if it has none or does not say
    int threads = 0;
    std::uint64_t seed = 0;
    std::uint64_t scene_hash = 0;
    std::string light_sampler;         ///< type, or empty if there is none
    std::vector<std::string> plugins;  ///< that were opened

    double rays_per_second() const;
};

/// Fills in what the film tells: samples, error, samples and pixels that are missing.
void describe_film(const FilmState& film, RenderFigures& figures);

/// "load 0.01 s, build 0.12 s, render 3.45 s; 64 spp; 5.67 Mrays/s; relMSE 1.2e-03 (95 %:
/// 1.1e-03 … 1.3e-03)"
std::string figures_text(const RenderFigures& figures);
/// Its end: "; relMSE 1.2e-03 (95 %: 1.1e-03 … 1.3e-03)"
std::string error_text(const RenderFigures& figures);
/// What a user must be told: dropped samples, rays and pixels. A line each, or empty.
std::string figures_warnings(const RenderFigures& figures);

Json to_json(const RenderFigures& figures);

/// Largest resident memory of the process so far [bytes].
std::uint64_t peak_memory();
/// Processor time of the process so far [s].
double cpu_seconds();

}  // namespace lucerna
