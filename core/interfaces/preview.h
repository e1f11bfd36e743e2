// SPDX-License-Identifier: Apache-2.0
/// Shows a render while it grows: `lucerna render --preview NAME` is plugins/previews/NAME.cpp.
///
/// core/render/preview_feed.h decides when there is something to show, and keeps previews from
/// slowing the render.
#pragma once

#include "core/image/image.h"
#include "core/plugin/plugin.h"

#include <functional>
#include <string>

namespace lucerna {

struct RenderFigures;
struct RenderStatus;

/// What is rendered.
struct PreviewSubject {
    std::string name;              ///< of the picture's file
    double exposure = 0;           ///< to begin with, in factors of two
    std::function<void()> stop{};  ///< ends the render as SIGINT does; any thread may call it
};

/// The picture as it is after a pass.
struct PreviewPicture {
    Image image;            ///< of the crop window, linear R, G, B
    Vector2i offset{0};     ///< of the crop window in the whole image [pixels]
    Vector2i full_size{0};  ///< of the whole image [pixels]
};

/// All functions but `watched` and `cancel` are called by one thread at a time. Those that show
/// something throw Error if that fails; the render goes on.
class Preview : public Object {
public:
    static constexpr const char* kind = "preview";
    ~Preview() override;

    /// Before the scene is read. `place` is what the command line has after the plugin's name and a
    /// colon. Throws Error if nothing can ever be shown there.
    virtual void open(const std::string& place, const PreviewSubject& subject) = 0;
    /// Whether somebody would see a picture now. Any thread may ask.
    virtual bool watched() const = 0;
    /// At the beginning of the render, then about twice a second.
    virtual void show_status(const RenderStatus& status) = 0;
    virtual void show_picture(const PreviewPicture& picture) = 0;
    /// The last call: the finished picture. Returns when it has arrived, or after `cancel`.
    virtual void finish(const PreviewPicture& picture, const RenderFigures& figures) = 0;
    /// From now on nothing waits for a viewer. Any thread may call it.
    virtual void cancel() = 0;
};

}  // namespace lucerna
