// SPDX-License-Identifier: Apache-2.0
/// The machine that a round was timed on, and whether the round had it to itself.
#pragma once

#include <chrono>
#include <string>

namespace lucerna {

struct Machine {
    std::string node;       ///< its name; Slurm's, if it runs there
    std::string processor;  ///< the model
    std::string system;     ///< "Linux 6.1.0 x86_64"
    int cores = 0;          ///< processors that the system shows
    int threads = 0;        ///< that rendered
    /// Processors that other programs kept busy meanwhile, as a share of all; 0 if unknown.
    double other_load = 0;
};

/// This machine, with nothing said of its load.
Machine this_machine(int threads);

/// Tells what other programs took of the processors since it was made.
class LoadMeter {
public:
    LoadMeter();
    double other_load() const;

private:
    std::chrono::steady_clock::time_point begin_;
    double all_, own_;  ///< processor seconds at the beginning
};

}  // namespace lucerna
