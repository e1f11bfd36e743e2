// SPDX-License-Identifier: Apache-2.0
/// The state of a render as a file: a checkpoint, a shard, or a result to be refined further.
///
/// It is an OpenEXR picture that any viewer shows, with further channels "state.…": every sum as
/// two doubles, each double as two unsigned 32-bit channels, and the counts of samples. All is
/// covered by a checksum, since most damage to an EXR file goes unnoticed.
#pragma once

#include "core/render/film_state.h"

#include <filesystem>
#include <string>

namespace lucerna {

/// Which render a state belongs to.
struct RenderIdentity {
    std::uint64_t scene_hash = 0;
    std::uint64_t seed = 0;
};

struct RenderState {
    FilmState film;
    RenderIdentity identity;
    double seconds = 0;  ///< spent rendering so far
};

/// Writes the state; the file is there completely or not at all. Throws FileError.
void write_state(const std::filesystem::path& path, const FilmState& film,
                 const RenderIdentity& identity, double seconds);

/// Throws FileError for a file that is not a state, is damaged, or of another version of Lucerna.
RenderState read_state(const std::filesystem::path& path);

/// Throws Error, saying what differs, unless a state can be continued by a render of this scene.
void check_continues(const RenderState& state, const FilmLayout& layout,
                     const RenderIdentity& identity, const std::filesystem::path& path);

}  // namespace lucerna
