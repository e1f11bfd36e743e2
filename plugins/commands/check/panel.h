// SPDX-License-Identifier: Apache-2.0
/// A small picture of numbers, and a sheet of them.
#pragma once

#include "core/math/vector.h"

#include <filesystem>
#include <vector>

namespace lucerna {

/// Rows run from top to bottom.
struct Panel {
    int width, height;
    std::vector<Color> pixels;  ///< linear, in [0, 1]

    Panel(int w, int h)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    Color& at(int x, int y) {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

/// Numbers over a rectangle; those that are sampled are added up.
struct Field {
    int width, height;
    std::vector<double> values;

    Field(int w, int h)
        : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}

    double& at(int x, int y) {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
    /// Adds at (u, v) of the unit square, v upwards; outside nothing happens.
    void add(double u, double v, double value);
    double largest() const;
    /// As brightness, the square root of value / `white`, from black over red to white.
    Panel show(double white) const;
};

/// Rows of panels on a dark ground, as a PNG; small panels are enlarged. Throws FileError.
void write_sheet(const std::vector<std::vector<Panel>>& rows, const std::filesystem::path& path);

}  // namespace lucerna
