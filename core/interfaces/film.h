// SPDX-License-Identifier: Apache-2.0
/// The image to be made: its size, its filter, its file.
///
/// Pixels are accumulated by core/render/film_state.h, the same for all films; a film says what is
/// rendered and how the result is stored.
#pragma once

#include "core/interfaces/rfilter.h"
#include "core/math/vector.h"
#include "core/plugin/plugin.h"

#include <filesystem>

namespace lucerna {

struct ImageFile;

/// Part of the image that is rendered, in pixels; width and height > 0.
struct CropWindow {
    Vector2i offset{0};
    Vector2i size{0};
    bool operator==(const CropWindow& o) const { return offset == o.offset && size == o.size; }
};

class Film : public Object {
public:
    static constexpr const char* kind = "film";
    ~Film() override;

    /// Size of the whole image [pixels].
    virtual Vector2i size() const = 0;
    virtual CropWindow crop() const = 0;
    virtual const RFilter& rfilter() const = 0;
    /// ".exr" or ".png": what `write` makes.
    virtual const char* extension() const = 0;
    /// Stores a finished image (channels R, G, B, A and layers, linear, with metadata), replacing
    /// the file in one step. Throws FileError; the old file then survives.
    virtual void write(const ImageFile& image, const std::filesystem::path& path) const = 0;
};

}  // namespace lucerna
