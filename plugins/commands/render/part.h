// SPDX-License-Identifier: Apache-2.0
/// One part of a render that is spread over machines: `lucerna render --part`.
///
/// The part's file appears when the part is finished. Until then its checkpoint is kept beside it,
/// and whoever runs the same command goes on from there. Tasks that render the same part at once
/// replace each other's files by equal ones.
#pragma once

#include "core/render/session.h"
#include "plugins/commands/render/display.h"
#include "plugins/commands/render/request.h"

#include <filesystem>
#include <optional>
#include <string>

namespace lucerna {

class PartRendering {
public:
    /// Reads and builds the scene. Throws Error if there are more parts than samples.
    /// `preview` may be null.
    PartRendering(const Request& request, Preview* preview);

    /// Returns the exit code.
    int run();

private:
    /// The state that a file holds if it is one of this part. Damaged files count as absent, with a
    /// warning; throws Error for those of other renders.
    std::optional<RenderState> kept(const std::filesystem::path& path) const;
    bool is_finished(const RenderState& state) const;
    RenderOptions options(const RenderState& from);
    void save(const std::filesystem::path& path, const FilmState& film, double seconds) const;
    void save_checkpoint(const FilmState& film, double seconds);
    void remove_checkpoint() const;
    int finish(const RenderResult& result, double seconds);
    void print(const RenderResult& result) const;

    std::string name() const { return "part " + request_.part_text; }
    PartRecord record() const;

    const Request& request_;
    std::filesystem::path file_, checkpoint_;
    Session session_;
    std::uint64_t all_samples_ = 0;
    SampleRange range_;
    Display display_;
    double begin_;                       ///< when rendering began, before restarts [s since 1970]
    std::set<std::uint64_t> roundings_;  ///< before a restart
    double last_checkpoint_ = 0;
};

}  // namespace lucerna
