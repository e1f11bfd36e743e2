// SPDX-License-Identifier: Apache-2.0
/// The state of a render as a file: a checkpoint, a shard, or a result to be refined further.
///
/// A part of a render (`lucerna render --part`) also says which samples it was to have.
///
/// It is an OpenEXR picture that any viewer shows. After the picture's end, where viewers do not
/// look, follow the film's sums in bands of rows, packed (packed_sums.h), then the size and the
/// hash of each band, and at the very end a trailer. Hashes cover every byte.
#pragma once

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/render/film_state.h"
#include "core/render/sample_ranges.h"

#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

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
    bool uneven = false;            ///< some pixels have more: a pass was interrupted
    SampleRanges planned = {};      ///< that it is to have
    std::uint64_t all_samples = 0;  ///< of the whole render; 0: the state is not a part
    double time_limit = 0;          ///< seconds that the part might take; 0: no limit
    int parts = 0;                  ///< that were merged
    double begin = 0, end = 0;      ///< of rendering, on all machines [s since 1970]
    std::string scene = {}, integrator = {}, light_sampler = {};
    std::string film = {};                   ///< film_text
    std::set<std::uint64_t> roundings = {};  ///< processor_rounding() where it was rendered
};

/// A warning if a state comes from processors that do not give the same bits, or empty.
std::string rounding_warning(const PartRecord& part);

struct RenderState {
    FilmState film;
    RenderIdentity identity;
    double seconds = 0;  ///< spent rendering so far, on all machines together
    PartRecord part = {};
};

/// Writes the state; the file is there completely or not at all. Unless `part` says which samples
/// the film has, they are those from film.first_sample() on. Throws FileError.
void write_state(const std::filesystem::path& path, const FilmState& film,
                 const RenderIdentity& identity, double seconds, const PartRecord& part = {});

/// A state that is read in bands of rows, so that many can be added without holding them.
class StateFile {
public:
    /// Reads what the file says of the state. Throws FileError for a file that is not a state or is
    /// damaged, VersionError for one of another version of Lucerna.
    explicit StateFile(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    const FilmLayout& layout() const { return layout_; }
    std::uint64_t first_sample() const { return first_sample_; }
    const RenderIdentity& identity() const { return identity_; }
    double seconds() const { return seconds_; }
    const PartRecord& part() const { return part_; }

    std::size_t band_count() const { return bands_.size(); }
    /// Adds the sums of some rows to a film of the same layout; different bands may be added at the
    /// same time. Throws FileError for damaged bands.
    void add_band(std::size_t band, FilmState& film) const;

private:
    struct Band {
        std::uint64_t offset, size, hash;
    };
    void read_header(std::span<const std::uint8_t> picture);
    [[noreturn]] void fail_damaged() const;

    std::filesystem::path path_;
    FileReader file_;
    std::vector<Band> bands_;
    FilmLayout layout_;
    std::uint64_t first_sample_ = 0;
    RenderIdentity identity_;
    double seconds_ = 0;
    PartRecord part_;
};

/// A whole state. Throws as StateFile.
RenderState read_state(const std::filesystem::path& path);

/// Throws Error, saying what differs, unless a state can be continued by a render of this scene.
void check_continues(const RenderState& state, const FilmLayout& layout,
                     const RenderIdentity& identity, const std::filesystem::path& path);

}  // namespace lucerna
