// SPDX-License-Identifier: Apache-2.0
/// The state of a render as a file: a checkpoint, a shard, or a result to be refined further.
///
/// A part of a render (`lucerna render --part`) also says which samples it was to have.
///
/// It is an OpenEXR picture that any viewer shows, with further channels "state.…": every sum as
/// two doubles, each double as two unsigned 32-bit channels, and the counts of samples. All is
/// covered by a checksum, since most damage to an EXR file goes unnoticed.
#pragma once

#include "core/plugin/error.h"
#include "core/render/film_state.h"
#include "core/render/sample_ranges.h"

#include <filesystem>
#include <string>

namespace lucerna {

/// Which render a state belongs to.
struct RenderIdentity {
    std::uint64_t scene_hash = 0;
    std::uint64_t seed = 0;
};

/// A state that another version of Lucerna wrote.
class VersionError : public FileError {
public:
    using FileError::FileError;
    ~VersionError() override;
};

/// Which part of a render a state is, and what its picture is to look like: states are merged
/// without their scene.
struct PartRecord {
    SampleRanges samples = {};      ///< that the film has of every pixel
    SampleRanges planned = {};      ///< that it is to have
    std::uint64_t all_samples = 0;  ///< of the whole render; 0: the state is not a part
    double time_limit = 0;          ///< seconds that the part might take; 0: no limit
    int parts = 0;                  ///< that were merged
    double begin = 0, end = 0;      ///< of rendering, on all machines [s since 1970]
    std::string scene = {}, integrator = {}, light_sampler = {};
    std::string film = {};  ///< film_text
};

struct RenderState {
    FilmState film;
    RenderIdentity identity;
    double seconds = 0;  ///< spent rendering so far, on all machines together
    PartRecord part = {};
};

/// Writes the state; the file is there completely or not at all. Throws FileError.
void write_state(const std::filesystem::path& path, const FilmState& film,
                 const RenderIdentity& identity, double seconds, const PartRecord& part = {});

/// Throws FileError for a file that is not a state or is damaged, VersionError for one of another
/// version of Lucerna.
RenderState read_state(const std::filesystem::path& path);

/// Throws Error, saying what differs, unless a state can be continued by a render of this scene.
void check_continues(const RenderState& state, const FilmLayout& layout,
                     const RenderIdentity& identity, const std::filesystem::path& path);

}  // namespace lucerna
