// SPDX-License-Identifier: Apache-2.0
/// The picture that all others are measured against: read from a file, or rendered once and kept.
#pragma once

#include "core/image/image.h"
#include "core/render/session.h"
#include "core/render/state_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

struct Reference {
    Image image;
    std::vector<Image> halves{};           ///< two, independent of each other, or none
    std::optional<ErrorEstimate> error{};  ///< its own, from the halves
    std::uint64_t samples = 0;             ///< per pixel; 0 if unknown
    double seconds = 0;                    ///< it took to render; 0 if unknown
    std::string source;                    ///< the file
    std::uint64_t scene_hash = 0;          ///< 0 if unknown
};

/// The colours of a film.
Image film_image(const FilmState& film);

/// What a state says of the render that it is of; `path` is its file.
Reference reference_from(const RenderState& state, const std::filesystem::path& path);

/// A file that the user gives. The state of a render (`--checkpoint`) tells its own noise; of other
/// pictures it is not known.
Reference read_reference(const std::filesystem::path& path);

/// Renders the reference, or what is missing of it: the state is kept in `path`, and used again by
/// every comparison of the same scene. The budget counts what the file holds already. Empty if it
/// was interrupted; what there is has been kept then.
std::optional<Reference> rendered_reference(const Session& session,
                                            const std::filesystem::path& path, std::uint64_t seed,
                                            const RenderOptions& options, bool quiet);

}  // namespace lucerna
