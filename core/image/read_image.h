// SPDX-License-Identifier: Apache-2.0
/// Reading an image of any known format.
#pragma once

#include <filesystem>

#include "core/image/image.h"

namespace lucerna {

/// What of an OpenEXR file is wanted: the picture (the display window, zero where nothing is
/// stored), or all pixels that are stored, wherever they lie (the data window).
enum class ExrWindow { display, data };

/// Reads an OpenEXR (main layer), PNG, JPEG or Radiance file; the first bytes decide, not the name.
/// Throws FileError if the file is missing, not a regular file, of another format, or damaged.
Image read_image(const std::filesystem::path& path, ExrWindow window = ExrWindow::display);

}  // namespace lucerna
