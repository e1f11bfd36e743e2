// SPDX-License-Identifier: Apache-2.0
#include "core/render/progress.h"

#include <fmt/format.h>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace lucerna {

namespace {

constexpr double line_fraction = 0.1;
constexpr double line_seconds = 30;
constexpr double line_pause = 1;
constexpr double json_pause = 1;
constexpr int default_width = 80;
constexpr int longest_bar = 40;

int terminal_width() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : default_width;
}

}  // namespace

std::string duration_text(double seconds) {
    // Also what a forecast of no use could give.
    if (!(seconds >= 0) || seconds > 1e9) return "?";
    const long long s = std::llround(seconds);
    if (s < 3600) return fmt::format("{}:{:02}", s / 60, s % 60);
    return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

Json to_json(const RenderStatus& status) {
    Json json = Json::object();
    json.set("seconds", status.seconds).set("fraction", status.fraction);
    json.set("seconds_left", status.seconds_left);
    json.set("samples_per_pixel", std::floor(status.samples));
    json.set("rays_per_second", status.rays_per_second);
    const std::optional<ErrorEstimate>& error = status.error;
    json.set("relative_mse", error ? Json(error->relative_mse) : Json());
    json.set("relative_mse_low", error ? Json(error->low) : Json());
    json.set("relative_mse_high", error ? Json(error->high) : Json());
    return json;
}

std::string progress_text(const RenderStatus& status) {
    std::string text =
        fmt::format("{:3.0f} %  {:.0f} spp", 100 * status.fraction, std::floor(status.samples));
    if (status.rays_per_second > 0) {
        text += fmt::format("  {:.2f} Mrays/s", status.rays_per_second * 1e-6);
    }
    if (status.error) text += fmt::format("  relMSE {:.2g}", status.error->relative_mse);
    if (status.seconds_left) text += "  " + duration_text(*status.seconds_left) + " left";
    return text;
}

std::string progress_bar(const RenderStatus& status, int width) {
    const std::string text = progress_text(status);
    const int room = std::min(width - static_cast<int>(text.size()) - 4, longest_bar);
    if (room < 5) return text.substr(0, static_cast<std::size_t>(std::max(width, 0)));
    const int filled = std::clamp(static_cast<int>(status.fraction * room), 0, room);
    std::string bar(static_cast<std::size_t>(filled), '=');
    if (filled < room) bar += '>';
    bar.resize(static_cast<std::size_t>(room), ' ');
    return "[" + bar + "] " + text;
}

Progress::Mode Progress::choose(bool quiet) {
    if (quiet) return Mode::none;
    const char* terminal = std::getenv("TERM");
    const bool movable = terminal && std::string_view(terminal) != "dumb";
    return isatty(STDERR_FILENO) && movable ? Mode::bar : Mode::lines;
}

void Progress::update(const RenderStatus& status) {
    if (mode_ == Mode::none) return;
    if (mode_ == Mode::json) return print_json(status);
    if (mode_ == Mode::bar) {
        // Return to the first column, write, erase what is left of the old text.
        fmt::print(stderr, "\r{}\x1b[K", progress_bar(status, terminal_width() - 1));
        std::fflush(stderr);
        drawn_ = true;
        return;
    }
    const double waited = status.seconds - lines_seconds_;
    const bool gained = status.fraction >= lines_fraction_ + line_fraction;
    if (waited < (gained ? line_pause : line_seconds)) return;
    lines_fraction_ = std::floor(status.fraction / line_fraction) * line_fraction;
    lines_seconds_ = status.seconds;
    fmt::print(stderr, "{}  {}\n", duration_text(status.seconds), progress_text(status));
}

void Progress::print_json(const RenderStatus& status) {
    if (status.seconds < json_seconds_ + json_pause) return;
    json_seconds_ = std::floor(status.seconds / json_pause) * json_pause;
    Json json = Json::object();
    json.set("schema", 1).set("state", "rendering").set("progress", to_json(status));
    std::fputs(json.line().c_str(), stdout);
    std::fflush(stdout);
}

void Progress::clear() {
    if (!drawn_) return;
    fmt::print(stderr, "\r\x1b[K");
    std::fflush(stderr);
    drawn_ = false;
}

}  // namespace lucerna
