// SPDX-License-Identifier: Apache-2.0
#include "core/render/preview_feed.h"

#include "core/base/error.h"
#include "core/plugin/build_context.h"
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include <time.h>

namespace lucerna {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// The most of the processors' time that copying and showing may take. Viewers that fetch a picture
/// take some more.
constexpr double share_of_time = 0.005;
constexpr double least_interval = 0.5;  // [s]
constexpr std::chrono::milliseconds status_interval = 500ms;
constexpr std::chrono::milliseconds longest_farewell = 2s;

double processor_seconds_of_thread() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

std::unique_ptr<Preview> open_preview(Registry& registry, const std::string& text,
                                      const PreviewSubject& subject) {
    const std::size_t colon = text.find(':');
    std::string name = text.substr(0, colon);
    std::string place = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (registry.path(Preview::kind, name).empty()) {
        const std::vector<std::string> names = registry.names(Preview::kind);
        if (colon == std::string::npos) {
            throw Error(
                fmt::format("there is no preview {}{}\n  there are: {}; HOST:PORT is a {} "
                            "that listens there",
                            quote(text), did_you_mean(text, names), join(names),
                            default_plugin(Preview::kind)));
        }
        name = default_plugin(Preview::kind);
        place = text;
    }
    std::unique_ptr<Object> object = make_object(registry, Preview::kind, name);
    std::unique_ptr<Preview> preview(static_cast<Preview*>(object.release()));
    preview->open(place, subject);
    return preview;
}

PreviewFeed::PreviewFeed(Preview& preview, int threads)
    : preview_(preview), workers_(threads), thread_([this] { run(); }) {}

PreviewFeed::~PreviewFeed() {
    preview_.cancel();
    {
        const Lock lock(mutex_);
        closed_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void PreviewFeed::update(const RenderStatus& status) {
    const Lock lock(mutex_);
    status_ = status;
}

void PreviewFeed::after_pass(const RenderStatus& status, const FilmState& film) {
    update(status);
    if (!preview_.watched()) return;
    double cost = copy_seconds_;
    {
        const Lock lock(mutex_);
        if (task_ != Task::none) return;
        cost += show_seconds_ / workers_.count();
    }
    const double interval = std::max(least_interval, cost / share_of_time);
    if (status.seconds < shown_seconds_ + interval) return;
    shown_seconds_ = status.seconds;
    copy_picture(film);
    hand_over(Task::show);
}

void PreviewFeed::finish(const FilmState& film, const RenderFigures& figures) {
    const bool idle = wait_until_idle();
    if (!preview_.watched()) return;
    if (idle) {
        copy_picture(film);
        figures_ = figures;
        hand_over(Task::finish);
        if (wait_until_idle()) return;
    }
    const Lock lock(mutex_);
    if (!warned_) warning_ = "the preview did not take the last picture in time";
    warned_ = true;
}

std::optional<std::string> PreviewFeed::take_warning() {
    const Lock lock(mutex_);
    return std::exchange(warning_, std::nullopt);
}

void PreviewFeed::copy_picture(const FilmState& film) {
    const Clock::time_point begin = Clock::now();
    const FilmLayout& layout = film.layout();
    const Vector2i size = layout.crop.size;
    Image& image = picture_.image;
    if (image.width != size.x || image.height != size.y) image = Image(size.x, size.y);
    picture_.offset = layout.crop.offset;
    picture_.full_size = layout.full_size;
    workers_.run(size.y, [&](std::int64_t row) {
        const std::size_t width = static_cast<std::size_t>(size.x);
        const std::size_t first = static_cast<std::size_t>(row) * width;
        for (std::size_t i = first; i < first + width; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                image.pixels[3 * i + c] = static_cast<float>(film.mean(i, c));
            }
        }
    });
    copy_seconds_ = std::chrono::duration<double>(Clock::now() - begin).count();
}

void PreviewFeed::hand_over(Task task) {
    {
        const Lock lock(mutex_);
        task_ = task;
    }
    changed_.notify_all();
}

bool PreviewFeed::wait_until_idle() {
    Lock lock(mutex_);
    return changed_.wait_for(lock, longest_farewell, [&] { return task_ == Task::none; });
}

void PreviewFeed::run() {
    Lock lock(mutex_);
    while (!closed_) {
        const Task task = task_;
        const RenderStatus status = status_;
        lock.unlock();
        const double begin = processor_seconds_of_thread();
        std::optional<std::string> problem;
        try {
            perform(task, status);
        } catch (const std::exception& e) {
            problem = e.what();
        }
        const double seconds = processor_seconds_of_thread() - begin;
        lock.lock();
        if (problem && !std::exchange(warned_, true)) warning_ = problem;
        if (task != Task::none) {
            task_ = Task::none;
            show_seconds_ = seconds;
            changed_.notify_all();
        }
        changed_.wait_for(lock, status_interval, [&] { return closed_ || task_ != Task::none; });
    }
}

void PreviewFeed::perform(Task task, const RenderStatus& status) {
    if (task == Task::finish) return preview_.finish(picture_, figures_);
    preview_.show_status(status);
    if (task == Task::show) preview_.show_picture(picture_);
}

}  // namespace lucerna
