// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/machine.h"

#include "core/render/statistics.h"

#include <fmt/format.h>

#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

namespace lucerna {

namespace {

std::string processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown processor";
}

/// Seconds that all processors of the machine were busy, since it was started.
double busy_seconds() {
    std::ifstream stat("/proc/stat");
    std::string cpu;
    double user = 0, nice = 0, system = 0;
    if (!(stat >> cpu >> user >> nice >> system)) return 0;
    return (user + nice + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

int core_count() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

}  // namespace

Machine this_machine(int threads) {
    utsname names{};
    uname(&names);
    const char* const node = std::getenv("SLURMD_NODENAME");
    return {.node = node ? node : names.nodename,
            .processor = processor(),
            .system = fmt::format("{} {} {}", names.sysname, names.release, names.machine),
            .cores = core_count(),
            .threads = threads};
}

LoadMeter::LoadMeter()
    : begin_(std::chrono::steady_clock::now()), all_(busy_seconds()), own_(cpu_seconds()) {}

double LoadMeter::other_load() const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    const double others = (busy_seconds() - all_) - (cpu_seconds() - own_);
    return std::clamp(others / (passed.count() * core_count()), 0.0, 1.0);
}

}  // namespace lucerna
