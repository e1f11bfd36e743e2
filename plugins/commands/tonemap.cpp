// SPDX-License-Identifier: Apache-2.0
/// tonemap: shows a linear picture as a display would: EXR to PNG through a view of OpenColorIO.
#include "core/command_line/arguments.h"
#include "core/image/png.h"
#include "core/image/read_image.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"
#include "core/render/output.h"

#include <fmt/format.h>

#include <filesystem>

namespace lucerna {

namespace {

class TonemapCommand final : public Command {
public:
    explicit TonemapCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        std::string input, output, name;
        double exposure = 0;
        bool list = false;
        Arguments arguments("tonemap", "Shows a linear picture as a display would.");
        arguments.positional("INPUT", input, "an EXR, Radiance, PNG or JPEG file", true);
        arguments.positional("OUTPUT", output, "the PNG file; by default named after INPUT", true);
        arguments.option("--view", "DISPLAY/VIEW", name, "the default view if not given");
        arguments.option("--exposure", "EV", exposure, {.min = -100, .max = 100},
                         "brightness, in factors of two");
        arguments.flag("--list", list, "lists all views; the first is the default");
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        if (input.empty() && !list) {
            fmt::print(stderr, "lucerna tonemap: INPUT is required\n");
            return exit_code::usage;
        }
        ignore_write_signals();
        std::optional<PictureView> view;
        try {
            view = picture_view(name, exposure);
        } catch (const Error& e) {
            fmt::print(stderr, "lucerna tonemap: {}\n", e.what());
            return exit_code::scene;
        }
        return list ? print_views(view->color) : convert(*view, input, output);
    }

private:
    static int print_views(const ColorConfig& color) {
        for (const std::string& view : color.views()) fmt::print("{}\n", view);
        return exit_code::success;
    }

    static int convert(const PictureView& view, const std::string& input, std::string output) {
        if (output.empty()) output = std::filesystem::path(input).replace_extension(".png");
        if (output == input) {
            fmt::print(stderr, "lucerna tonemap: OUTPUT would replace INPUT\n");
            return exit_code::usage;
        }
        Image image = read_image(input, ExrWindow::data);
        view.color.to_rendering(image);
        const Image8 shown = view.color.display(image, view.name, view.exposure);
        write_png(output, shown);
        if (shown.non_finite > 0) {
            fmt::print(stderr, "warning: {} pixels are not finite\n", shown.non_finite);
        }
        fmt::print("{}\n", output);
        return exit_code::success;
    }
};

}  // namespace

const PluginInfo plugin = describe<TonemapCommand>("shows a linear picture as a display would");

}  // namespace lucerna
