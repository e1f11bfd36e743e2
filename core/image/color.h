// SPDX-License-Identifier: Apache-2.0
/// Colour: the sRGB curve, conversion of inputs to the rendering space, and of the rendering space
/// to a display. color.cpp is the only user of OpenColorIO, and touches it only where the sRGB
/// curve is not enough.
///
/// The rendering space is linear Rec.709 under the built-in configuration. Under a user's one it
/// is the role `rendering` if there is one, else linear Rec.709 if the configuration knows it, else
/// the role `scene_linear`.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/image.h"
#include "core/math/vector.h"

namespace lucerna {

/// IEC 61966-2-1, exactly as piecewise defined; mirrored below zero, not clamped above one.
float srgb_to_linear(float encoded);
float linear_to_srgb(float linear);
Color srgb_to_linear(Color encoded);
Color linear_to_srgb(Color linear);

/// Linear light of a value of an image that is encoded as `image` says.
float decoded(const Image& image, float value);

/// XYZ under D65 to linear Rec.709: the inverse of the primaries of ITU-R BT.709-6; columns.
inline const Matrix3d rec709_from_xyz(3.2409699419045226, -0.9692436362808796, 0.0556300796969936,
                                      -1.5373831775700940, 1.8759675015077202, -0.2039769588889765,
                                      -0.4986107602930034, 0.0415550574071756, 1.0569715142428786);

/// Matrix from linear RGB of these primaries and white to linear Rec.709; the white is adapted by
/// the Bradford transform. Throws Error if the primaries span no triangle.
Matrix3d rec709_from(const Chromaticities& chromaticities);

/// A colour configuration. Cheap to construct as long as it is the built-in one; safe from many
/// threads.
class ColorConfig {
public:
    /// The built-in configuration.
    ColorConfig();
    ~ColorConfig();
    ColorConfig(ColorConfig&&) noexcept;
    ColorConfig& operator=(ColorConfig&&) noexcept;

    /// The first of these that is given: `command_line` (a file, "builtin", or "none": no
    /// configuration, only linear and sRGB), the environment variable OCIO, `scene` (as
    /// `command_line`), the built-in. "ocio://…" means the built-in, and leaves a notice.
    /// Throws Error if a configuration that was asked for cannot be used.
    static ColorConfig choose(std::string_view command_line = "", std::string_view scene = "");

    /// Where it comes from, for messages and metadata: "built-in", "none", or a file.
    const std::string& source() const;
    /// What the user should be told once, or empty.
    const std::string& notice() const;
    /// The name of the rendering space.
    const std::string& rendering_space() const;

    /// Names of all colour spaces, without their aliases.
    std::vector<std::string> spaces() const;
    /// All views as "Display/View"; the default one first.
    std::vector<std::string> views() const;

    /// Converts an image in place to the rendering space and clears what it says of itself. `space`
    /// is any name or alias of the configuration, "raw" (numbers, left as they are), or "auto": the
    /// curve and the chromaticities that the image names, or channels X, Y and Z; linear Rec.709 if
    /// it names none.
    /// Alpha stays. Throws Error with the names there are if there is no such space.
    void to_rendering(Image& image, std::string_view space = "auto") const;
    /// The same for one colour; "auto" is linear Rec.709.
    Color to_rendering(Color color, std::string_view space) const;

    /// What a display shows: rendering space · 2^exposure through a view, clamped to [0, 1] and
    /// rounded to bytes. `view` is one of `views()`, the part after its "/", or empty for the
    /// default. NaN becomes 0 and infinities the ends of the range; such pixels are counted.
    /// Images with a channel "A" give four channels. Throws Error if there is no such view.
    Image8 display(const Image& image, std::string_view view = "", double exposure = 0) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace lucerna
