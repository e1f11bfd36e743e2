// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/render/display.h"

#include "core/render/interrupt.h"
#include "core/render/output.h"

#include <fmt/format.h>

#include <cstdio>

namespace lucerna {

std::unique_ptr<Preview> preview_of(const Request& request) {
    if (request.preview.empty()) return nullptr;
    Registry registry({request.plugin_folders.begin(), request.plugin_folders.end()});
    return open_preview(registry, request.preview,
                        {.name = PicturePaths(request.output, request.scene).exr.string(),
                         .exposure = request.exposure,
                         .stop = InterruptGuard::interrupt});
}

Display::Display(const Request& request, Preview* preview)
    : request_(request),
      preview_(preview),
      progress_(request.json_progress ? Progress::Mode::json : Progress::choose(request.quiet)) {}

void Display::begin() {
    if (preview_) feed_.emplace(*preview_, request_.threads);
}

void Display::report(const RenderStatus& status) {
    progress_.update(status);
    if (!feed_) return;
    feed_->update(status);
    print_warning();
}

void Display::after_pass(const RenderStatus& status, const FilmState& film) {
    if (feed_) feed_->after_pass(status, film);
}

void Display::finish(const FilmState& film, const RenderFigures& figures) {
    if (!feed_) return;
    feed_->finish(film, figures);
    print_warning();
}

void Display::print_warning() {
    const std::optional<std::string> warning = feed_->take_warning();
    if (!warning) return;
    progress_.clear();
    fmt::print(stderr, "warning: {}\n", *warning);
}

}  // namespace lucerna
