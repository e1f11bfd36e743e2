// SPDX-License-Identifier: Apache-2.0
/// The pictures of a finished render: linear in an EXR file, as a display shows it in a PNG file,
/// and in the film's own kind of file, if that is another.
#pragma once

#include "core/image/color.h"
#include "core/render/session.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lucerna {

/// Where a render is stored: files that differ in their extension.
struct PicturePaths {
    std::filesystem::path exr, png;

    /// Of another kind of file; `extension` begins with a dot.
    std::filesystem::path other(const char* extension) const;

    /// `output` with or without one of the extensions (".pfm", too); if it is empty, the scene's
    /// name, in the current directory.
    PicturePaths(std::filesystem::path output, const std::filesystem::path& scene);
    /// Throws FileError if one of them, or that of extension `own`, could not be written: to be
    /// called before rendering.
    void check(const char* own = ".exr") const;
};

/// How the PNG shows the picture: see ColorConfig::display.
struct PictureView {
    ColorConfig color;
    std::string name;
    double exposure = 0;
};

/// The view of this name (empty: the default one) in the configuration that is chosen by the
/// environment. Throws Error, before anything is rendered, if there is no such view.
PictureView picture_view(const std::string& name, double exposure);

/// The image and, as metadata, what made it: command line, scene, seed, samples, seconds, error.
ImageFile annotated_image(const FilmState& film, const RenderFigures& figures,
                          const std::string& command, const std::string& scene);

/// Writes all files; the film decides how its own kind of file looks. Returns where they are.
/// Throws FileError.
std::vector<std::filesystem::path> write_pictures(const Film& film, const ImageFile& image,
                                                  const PicturePaths& paths,
                                                  const PictureView& view);

}  // namespace lucerna
