// SPDX-License-Identifier: Apache-2.0
/// What is seen of a render while it goes on: its progress, as text or JSON, and a preview.
#pragma once

#include "core/render/preview_feed.h"
#include "core/render/progress.h"
#include "plugins/commands/render/request.h"

#include <memory>
#include <optional>

namespace lucerna {

/// The preview that is asked for, opened; null if there is none. Throws Error, PluginError.
std::unique_ptr<Preview> preview_of(const Request& request);

class Display {
public:
    /// `preview` may be null.
    Display(const Request& request, Preview* preview);

    /// Nobody looks: status need not be reported.
    bool is_idle() const { return !preview_ && !request_.json_progress && request_.quiet; }

    /// The render begins.
    void begin();
    void report(const RenderStatus& status);
    void after_pass(const RenderStatus& status, const FilmState& film);
    /// Makes place for other lines on the terminal.
    void clear() { progress_.clear(); }
    /// Shows the finished picture; returns when it has arrived, after some seconds at most.
    void finish(const FilmState& film, const RenderFigures& figures);

private:
    void print_warning();

    const Request& request_;
    Preview* preview_;
    Progress progress_;
    std::optional<PreviewFeed> feed_;
};

}  // namespace lucerna
