// SPDX-License-Identifier: Apache-2.0
/// Feeds a preview from a running render, in a thread of its own.
///
/// The render only copies its picture, after passes, if somebody is watching, and so rarely that
/// copying and showing take a hundredth of the processors' time. It never waits for a viewer.
#pragma once

#include "core/base/parallel.h"
#include "core/interfaces/preview.h"
#include "core/plugin/registry.h"
#include "core/render/render_job.h"
#include "core/render/statistics.h"

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace lucerna {

/// Opens the preview that is meant by "NAME", "NAME:PLACE", or "HOST:PORT", which is the place of
/// the default one. Throws Error if there is no such preview.
std::unique_ptr<Preview> open_preview(Registry& registry, const std::string& text,
                                      const PreviewSubject& subject);

class PreviewFeed {
public:
    /// Renders use `threads` threads; 0: all processors.
    PreviewFeed(Preview& preview, int threads);
    /// Waits for no viewer.
    ~PreviewFeed();
    PreviewFeed(const PreviewFeed&) = delete;
    PreviewFeed& operator=(const PreviewFeed&) = delete;

    /// To be called often, from any thread.
    void update(const RenderStatus& status);
    /// To be called after every pass, by the thread that renders.
    void after_pass(const RenderStatus& status, const FilmState& film);
    /// Shows the finished picture; returns when it has arrived, after some seconds at most.
    void finish(const FilmState& film, const RenderFigures& figures);
    /// What the preview complained about first, once.
    std::optional<std::string> take_warning();

private:
    using Lock = std::unique_lock<std::mutex>;
    enum class Task { none, begin, show, finish };
    void run();
    void perform(Task task, const RenderStatus& status);
    void copy_picture(const FilmState& film);
    void hand_over(Task task);
    bool wait_until_idle();

    Preview& preview_;
    Workers workers_;
    double copy_seconds_ = 0;   ///< of the last picture
    double shown_seconds_ = 0;  ///< when it was copied, since the render began

    std::mutex mutex_;
    std::condition_variable changed_;
    RenderStatus status_;
    Task task_ = Task::begin;
    bool closed_ = false;
    double show_seconds_ = 0;  ///< processor time that showing the last picture took
    std::optional<std::string> warning_;
    bool warned_ = false;

    /// Belongs to the render while there is no task, else to the thread.
    PreviewPicture picture_;
    RenderFigures figures_;
    std::thread thread_;
};

}  // namespace lucerna
