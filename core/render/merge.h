// SPDX-License-Identifier: Apache-2.0
/// Parts of a render become the whole: the states of disjoint ranges of samples are added.
///
/// Sums are exact, so the order of the files and merging in several steps change no bit.
#pragma once

#include "core/render/state_file.h"

#include <filesystem>
#include <vector>

namespace lucerna {

/// All samples of the states. Needs the memory of one film, however many states there are. Throws
/// Error, naming both files, for states of different renders or with the same samples; FileError as
/// read_state.
RenderState merge_states(const std::vector<std::filesystem::path>& paths);

/// The samples of the whole render that no part was to have: those of parts that are absent.
SampleRanges absent_samples(const PartRecord& part);
/// Those that parts were to have and lack, since their time was over.
SampleRanges unfinished_samples(const PartRecord& part);

}  // namespace lucerna
