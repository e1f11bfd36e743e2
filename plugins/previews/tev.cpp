// SPDX-License-Identifier: Apache-2.0
/// tev: sends the picture to the viewer tev (https://github.com/Tom94/tev) over its protocol.
///
/// While the render goes on, tev has a picture "NAME (rendering)". In the end one whose name has
/// the figures takes its place. tev never answers, so all that can be known of it is whether it
/// takes what it is sent.
#include "core/interfaces/preview.h"
#include "core/render/render_job.h"
#include "core/render/statistics.h"
#include "plugins/previews/tcp_sender.h"
#include "plugins/previews/tev_packets.h"

namespace lucerna {

namespace {

using namespace std::chrono_literals;
using Clock = TcpSender::Clock;

constexpr int default_port = 14158;
/// As tev's own client cuts pictures.
constexpr int tile_size = 128;
constexpr std::chrono::seconds between_attempts = 5s, longest_stall = 5s, longest_connect = 1s;

std::string short_figures(const RenderFigures& figures) {
    std::string text = fmt::format("{} spp, {:.1f} s", figures.samples,
                                   figures.earlier_seconds + figures.render_seconds);
    if (figures.error) text += fmt::format(", relMSE {:.2g}", figures.error->relative_mse);
    return text;
}

class TevPreview final : public Preview {
public:
    explicit TevPreview(const Params&) {}

    void open(const std::string& place, const PreviewSubject& subject) override {
        place_ = parse_place(place, {"127.0.0.1", default_port});
        sender_.find(place_);
        name_ = subject.name;
    }
    bool watched() const override { return sender_.connected(); }
    void cancel() override { sender_.cancel(); }

    void show_status(const RenderStatus&) override {
        if (sender_.connected() || Clock::now() < next_attempt_) return;
        next_attempt_ = Clock::now() + between_attempts;
        try {
            sender_.connect(longest_connect);
        } catch (const Error& e) {
            throw Error(
                fmt::format("there is no tev at {} ({}); the render goes on, and shows "
                            "itself once tev is there",
                            place_.text(), e.what()));
        }
        created_ = false;
    }
    void show_picture(const PreviewPicture& picture) override {
        if (sender_.connected()) update(growing(), picture);
    }
    void finish(const PreviewPicture& picture, const RenderFigures& figures) override {
        const bool was_shown = created_;
        created_ = false;
        update(fmt::format("{} ({})", name_, short_figures(figures)), picture);
        if (was_shown) send(tev_close_image(growing()));
    }

private:
    std::string growing() const { return name_ + " (rendering)"; }

    void update(const std::string& name, const PreviewPicture& picture) {
        if (!created_) send(tev_create_image(name, picture.full_size));
        created_ = true;
        const Vector2i size(picture.image.width, picture.image.height);
        for (int y = 0; y < size.y; y += tile_size) {
            for (int x = 0; x < size.x; x += tile_size) {
                const Vector2i begin(x, y);
                const Vector2i tile = glm::min(size - begin, Vector2i(tile_size));
                send(tev_update_image(name, picture.image, picture.offset, begin, tile));
            }
        }
    }
    void send(const std::string& packet) {
        try {
            sender_.send(packet, longest_stall);
        } catch (const Error& e) {
            throw Error(
                fmt::format("tev at {} is gone ({}); the render goes on, and shows itself "
                            "once tev is back",
                            place_.text(), e.what()));
        }
    }

    Place place_;
    std::string name_;
    TcpSender sender_;
    Clock::time_point next_attempt_{};
    bool created_ = false;  ///< tev has the picture
};

}  // namespace

const PluginInfo plugin = describe<TevPreview>("shows the running render in the viewer tev");

}  // namespace lucerna
