// SPDX-License-Identifier: Apache-2.0
/// bitmap: a picture. uv (0, 0) is its lower left corner, (1, 1) its upper right one.
///
/// Colours are linear Rec.709 after reading, by the encoding that the file names (sRGB for 8 and 16
/// bits that name none), unless `raw` says that they are numbers. Alpha is never encoded, and is
/// not applied to the colours. Bilinear interpolation is done on linear values. `to_uv` maps
/// (u, 1 − v), which is (0, 0) in the upper left corner: so it means the same as in Mitsuba.
#include "plugins/textures/uv_transform.h"

#include "core/image/read_image.h"
#include "core/image/texels.h"
#include "core/interfaces/texture.h"

#include <fmt/format.h>

#include <cctype>
#include <optional>

namespace lucerna {

namespace {

enum class Wrap { repeat, mirror, clamp };

/// The two texels between whose centres a coordinate lies, and how far from the first.
struct Between {
    int first, second;
    float t;
};

/// std::floor without a call.
float floor_of(float x) {
    if (!(std::abs(x) < 0x1p23f)) return x;  // has no fraction, or is NaN
    const auto whole = static_cast<float>(static_cast<int>(x));
    return whole > x ? whole - 1 : whole;
}

/// Index i of n texels, for -1 <= i <= n, or up to 2n with mirror.
int wrapped(int i, int n, Wrap wrap) {
    switch (wrap) {
        case Wrap::clamp:
            return std::clamp(i, 0, n - 1);
        case Wrap::repeat:
            return i < 0 ? i + n : i >= n ? i - n : i;
        case Wrap::mirror:
            return std::max(i < n ? i : 2 * n - 1 - i, 0);
    }
    return 0;
}

Between between(float x, int n, Wrap wrap, bool nearest) {
    if (wrap == Wrap::repeat) x -= floor_of(x);
    if (wrap == Wrap::mirror) x -= 2 * floor_of(0.5f * x);
    if (wrap == Wrap::clamp) x = std::clamp(x, 0.0f, 1.0f);
    if (!(x >= 0 && x <= 2)) x = 0;  // NaN
    const float place = x * static_cast<float>(n) - (nearest ? 0.0f : 0.5f);
    const float below = floor_of(place);
    const int i = static_cast<int>(below);
    if (nearest) return {wrapped(i, n, wrap), wrapped(i, n, wrap), 0};
    return {wrapped(i, n, wrap), wrapped(i + 1, n, wrap), place - below};
}

FourFloats mixed(FourFloats a, FourFloats b, float t) { return a * (1 - t) + b * t; }

bool same_letters(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
        return std::tolower(x) == std::tolower(y);
    });
}

/// The channel of a picture that has this name in any case; a grey one has equal r, g and b.
std::optional<std::size_t> find_channel(const Image& image, std::string_view name) {
    for (std::size_t i = 0; i < image.channels.size(); ++i) {
        if (same_letters(image.channels[i], name)) return i;
    }
    const bool color =
        same_letters(name, "r") || same_letters(name, "g") || same_letters(name, "b");
    if (color && image.channels[0] == "Y") return 0;
    return {};
}

class Bitmap final : public Texture {
public:
    explicit Bitmap(const Params& params)
        : path_(params.file("filename",
                            "OpenEXR, PNG, JPEG, Radiance, BMP, TGA, PPM or PFM picture")),
          raw_(params.boolean("raw", false, "numbers, not colours: no conversion")),
          nearest_(params.choice<bool>(
              "filter_type", false,
              {{"bilinear", false}, {"nearest", true}, {"trilinear", false}, {"ewa", false}},
              "between texels; others of old scenes are bilinear")),
          wrap_(params.choice<Wrap>(
              "wrap_mode", Wrap::repeat,
              {{"repeat", Wrap::repeat}, {"mirror", Wrap::mirror}, {"clamp", Wrap::clamp}},
              "outside of the unit square")),
          to_uv_(params.transform("to_uv", "maps u and v")) {
        params.no_effect("format", "pictures are kept in as many bits as their numbers need");
        for (const char* name : {"accel", "cache", "max_anisotropy"}) {
            params.no_effect(name, "lookups are made by the CPU, without mipmaps");
        }
        const std::string channel =
            params.string("channel", "", "only this channel of the picture, as \"r\" or \"a\"");
        const float gamma = params.real("gamma", -1, any_value,
                                        "linear light is value^gamma, whatever the file says; 1 "
                                        "is raw, -1 as the file says");
        if (gamma <= 0 && gamma != -1) {
            params.error("gamma", "gamma must be positive, or -1 for what the file says");
        }
        raw_ = raw_ || gamma == 1;
        Image image = read_image(path_);
        if (!image.notice.empty()) {
            params.warning("filename", fmt::format("{}: {}", path_.string(), image.notice));
        }
        if (gamma > 0) {
            image.srgb_encoded = false;
            image.gamma = gamma;
        }
        texels_ = Texels(chosen(params, channel, std::move(image)), raw_);
        if (texels_.bad() > 0) {
            params.warning("filename", fmt::format("{}: {} pixels are not finite; they are taken "
                                                   "as 0",
                                                   path_.string(), texels_.bad()));
        }
        summarise();
    }

    Color color(Vector2 uv) const override {
        const Corners c = corners(uv);
        const FourFloats upper = mixed(texels_.at(c.place[0]), texels_.at(c.place[1]), c.t.x);
        const FourFloats lower = mixed(texels_.at(c.place[2]), texels_.at(c.place[3]), c.t.x);
        return to_vector3(mixed(upper, lower, c.t.y));
    }

    float real(Vector2 uv) const override { return number(color(uv)); }

    Vector2 gradient(Vector2 uv) const override {
        if (nearest_) return Vector2(0);
        const Corners c = corners(uv);
        const auto value = [&](std::size_t i) {
            return number(to_vector3(texels_.at(c.place[i])));
        };
        const float f00 = value(0), f10 = value(1), f01 = value(2), f11 = value(3);
        const Vector2 by_texel(glm::mix(f10 - f00, f11 - f01, c.t.y),
                               glm::mix(f01 - f00, f11 - f10, c.t.x));
        const Vector2 size(texels_.width(), texels_.height());
        return to_uv_.pull_back(by_texel * size);
    }

    float aspect() const override {
        return static_cast<float>(texels_.width()) / static_cast<float>(texels_.height());
    }
    Color mean() const override { return mean_; }
    float max() const override { return max_; }

private:
    /// The four texels around a point (upper left, upper right, lower left, lower right), and how
    /// far the point is from the first.
    struct Corners {
        std::array<std::size_t, 4> place;
        Vector2 t;
    };

    Corners corners(Vector2 uv) const {
        const Vector2 p = to_uv_(uv);
        const Between x = between(p.x, texels_.width(), wrap_, nearest_);
        const Between y = between(p.y, texels_.height(), wrap_, nearest_);
        const std::size_t left = texels_.column(x.first), right = texels_.column(x.second);
        const std::size_t above = texels_.row(y.first), below = texels_.row(y.second);
        return {{left + above, right + above, left + below, right + below}, {x.t, y.t}};
    }

    float number(Color c) const { return texels_.channels() == 1 ? c.x : luminance(c); }

    /// The channel of the picture that the scene asks for; all if it does not.
    Image chosen(const Params& params, const std::string& channel, Image image) const {
        if (channel.empty()) return image;
        const std::optional<std::size_t> index = find_channel(image, channel);
        if (!index) {
            params.error("channel", fmt::format("{} has no channel \"{}\"; there are: {}",
                                                path_.string(), channel, join(image.channels)));
            return image;
        }
        return one_channel(image, *index);
    }

    void summarise() {
        ColorD sum(0);
        for (int y = 0; y < texels_.height(); ++y) {
            for (int x = 0; x < texels_.width(); ++x) {
                const Color c = texels_(x, y);
                sum += ColorD(c);
                max_ = std::max(max_, max_component(c));
            }
        }
        mean_ = Color(sum / (static_cast<double>(texels_.width()) * texels_.height()));
    }

    std::filesystem::path path_;
    bool raw_, nearest_;
    Wrap wrap_;
    UVTransform to_uv_;
    Texels texels_;
    Color mean_{0};
    float max_ = -infinity;
};

}  // namespace

const PluginInfo plugin = describe<Bitmap>("a picture");

}  // namespace lucerna
