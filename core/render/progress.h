// SPDX-License-Identifier: Apache-2.0
/// Tells how far a render is: people on stderr, programs on stdout.
#pragma once

#include "core/base/json.h"
#include "core/render/render_job.h"

#include <string>

namespace lucerna {

/// A bar that is drawn anew on a terminal; elsewhere a line for every tenth of the work, but
/// none within a second of the last, and one at least every 30 seconds. Programs get a line of
/// JSON a second on stdout.
class Progress {
public:
    enum class Mode { none, lines, bar, json };

    /// `none` if quiet, `bar` on a terminal that can move its cursor, else `lines`.
    static Mode choose(bool quiet);

    explicit Progress(Mode mode) : mode_(mode) {}
    /// Leaves the terminal's line clean.
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// By one thread at a time.
    void update(const RenderStatus& status);
    /// Takes the bar away, so that something else can be printed.
    void clear();

private:
    void print_json(const RenderStatus& status);

    Mode mode_;
    bool drawn_ = false;
    double lines_fraction_ = 0, lines_seconds_ = 0;
    double json_seconds_ = -1;  ///< when the last line was due
};

Json to_json(const RenderStatus& status);

/// "42 %  64 spp  3.21 Mrays/s  relMSE 1.2e-03  0:07 left"
std::string progress_text(const RenderStatus& status);

/// "[=====>    ] " and the text, at most `width` columns.
std::string progress_bar(const RenderStatus& status, int width);

/// "0:07", "12:34" or "1:02:03"
std::string duration_text(double seconds);

}  // namespace lucerna
