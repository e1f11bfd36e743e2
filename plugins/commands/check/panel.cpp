// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/check/panel.h"

#include "core/image/color.h"
#include "core/image/png.h"

namespace lucerna {

void Field::add(double u, double v, double value) {
    if (!(u >= 0 && u < 1 && v >= 0 && v < 1)) return;
    at(static_cast<int>(u * width), static_cast<int>((1 - v) * (height - 1e-9))) += value;
}

double Field::largest() const {
    double result = 0;
    for (const double value : values) {
        if (std::isfinite(value)) result = std::max(result, value);
    }
    return result;
}

Panel Field::show(double white) const {
    Panel panel(width, height);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double level = white > 0 ? std::sqrt(std::clamp(values[i] / white, 0.0, 1.0)) : 0;
        const auto ramp = [&](double from) {
            return static_cast<float>(std::clamp(3 * level - from, 0.0, 1.0));
        };
        panel.pixels[i] = {ramp(0), ramp(1), ramp(2)};
    }
    return panel;
}

void write_sheet(const std::vector<std::vector<Panel>>& rows, const std::filesystem::path& path) {
    constexpr int gap = 8, shown = 480;  // pixels: between panels, width of one
    const auto factor = [](const Panel& p) { return std::max(1, shown / std::max(p.width, 1)); };
    Image8 sheet{.width = gap, .height = gap};
    for (const auto& row : rows) {
        int width = gap, height = 0;
        for (const Panel& panel : row) {
            width += factor(panel) * panel.width + gap;
            height = std::max(height, factor(panel) * panel.height);
        }
        sheet.width = std::max(sheet.width, width);
        sheet.height += height + gap;
    }
    sheet.pixels.assign(
        3 * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 40);
    int top = gap;
    for (const auto& row : rows) {
        int left = gap, height = 0;
        for (const Panel& panel : row) {
            const int f = factor(panel);
            for (int y = 0; y < f * panel.height; ++y) {
                for (int x = 0; x < f * panel.width; ++x) {
                    const auto source = static_cast<std::size_t>(y / f * panel.width + x / f);
                    const auto target =
                        static_cast<std::size_t>((top + y) * sheet.width + left + x);
                    for (int c = 0; c < 3; ++c) {
                        const float v = std::clamp(panel.pixels[source][c], 0.0f, 1.0f);
                        sheet.pixels[3 * target + static_cast<std::size_t>(c)] =
                            static_cast<std::uint8_t>(255 * linear_to_srgb(v) + 0.5f);
                    }
                }
            }
            left += f * panel.width + gap;
            height = std::max(height, f * panel.height);
        }
        top += height + gap;
    }
    write_png(path, sheet);
}

}  // namespace lucerna
