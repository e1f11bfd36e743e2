// SPDX-License-Identifier: Apache-2.0
/// A round of a comparison: one run of each variant, one after the other on one machine.
#pragma once

#include "core/image/image.h"
#include "core/render/statistics.h"
#include "plugins/commands/compare/machine.h"

#include <cstdint>
#include <vector>

namespace lucerna {

/// What a run had rendered after some of its samples.
struct Snapshot {
    double seconds = 0;         ///< rendering until then
    std::uint64_t samples = 0;  ///< per pixel
    Image image{};
};

/// One run, before it is measured against a reference.
struct RunRecord {
    RenderFigures figures{};
    double render_seconds = 0;  ///< without the time that snapshots took
    std::uint64_t memory = 0;   ///< most that was resident, snapshots not counted [bytes]
    std::vector<Snapshot>
        snapshots{};  ///< whenever samples have doubled; ends with the last picture
};

struct Round {
    int repeat = 0;  ///< counted from 0
    Machine machine{};
    std::vector<RunRecord> runs{};  ///< one for each variant, in their order
};

}  // namespace lucerna
