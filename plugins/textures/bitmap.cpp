// SPDX-License-Identifier: Apache-2.0
/// bitmap: a picture. uv (0, 0) is its lower left corner, (1, 1) its upper right one.
///
/// Colours are linear Rec.709 after reading (8 and 16 bit files are sRGB-encoded) unless `raw` says
/// that they are numbers. Bilinear interpolation is done on linear values. `to_uv` maps
/// (u, 1 − v), which is (0, 0) in the upper left corner: so it means the same as in Mitsuba.
#include "plugins/textures/texels.h"
#include "plugins/textures/uv_transform.h"

#include "core/image/read_image.h"
#include "core/interfaces/texture.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

enum class Wrap { repeat, mirror, clamp };

/// The two texels between whose centres a coordinate lies, and how far from the first.
struct Between {
    int first, second;
    float t;
};

/// Index i of n texels, for -1 <= i <= 2n.
int wrapped(int i, int n, Wrap wrap) {
    switch (wrap) {
        case Wrap::clamp:
            return std::clamp(i, 0, n - 1);
        case Wrap::repeat:
            return (i + n) % n;
        case Wrap::mirror: {
            const int j = (i + 2 * n) % (2 * n);
            return j < n ? j : 2 * n - 1 - j;
        }
    }
    return 0;
}

Between between(float x, int n, Wrap wrap, bool nearest) {
    if (wrap == Wrap::repeat) x -= std::floor(x);
    if (wrap == Wrap::mirror) x -= 2 * std::floor(0.5f * x);
    if (wrap == Wrap::clamp) x = std::clamp(x, 0.0f, 1.0f);
    if (!(x >= 0 && x <= 2)) x = 0;  // NaN
    const float place = x * static_cast<float>(n) - (nearest ? 0.0f : 0.5f);
    const float below = std::floor(place);
    const int i = static_cast<int>(below);
    if (nearest) return {wrapped(i, n, wrap), wrapped(i, n, wrap), 0};
    return {wrapped(i, n, wrap), wrapped(i + 1, n, wrap), place - below};
}

class Bitmap final : public Texture {
public:
    explicit Bitmap(const Params& params)
        : path_(params.file("filename", "OpenEXR, PNG, JPEG or Radiance picture")),
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
        const float gamma = params.real("gamma", -1, any_value, "of old scenes: 1 is raw, -1 sRGB");
        if (gamma == 1) raw_ = true;
        if (gamma != 1 && gamma != -1) {
            params.warning("gamma", "only 1 (raw) and -1 (sRGB) are known: sRGB is used");
        }
        params.no_effect("format", "8-bit pictures are kept as such, others as floats");
        for (const char* name : {"accel", "cache", "max_anisotropy"}) {
            params.no_effect(name, "lookups are made by the CPU, without mipmaps");
        }
        texels_ = Texels(read_image(path_), raw_);
        if (texels_.bad() > 0) {
            params.warning("filename", fmt::format("{}: {} pixels are not finite; they are taken "
                                                   "as 0",
                                                   path_.string(), texels_.bad()));
        }
        summarise();
    }

    Color color(Vector2 uv) const override {
        const auto [x, y] = place(uv);
        const Color upper = glm::mix(texels_(x.first, y.first), texels_(x.second, y.first), x.t);
        const Color lower = glm::mix(texels_(x.first, y.second), texels_(x.second, y.second), x.t);
        return glm::mix(upper, lower, y.t);
    }

    float real(Vector2 uv) const override { return number(color(uv)); }

    Vector2 gradient(Vector2 uv) const override {
        if (nearest_) return Vector2(0);
        const auto [x, y] = place(uv);
        const float f00 = number(texels_(x.first, y.first));
        const float f10 = number(texels_(x.second, y.first));
        const float f01 = number(texels_(x.first, y.second));
        const float f11 = number(texels_(x.second, y.second));
        const Vector2 by_texel(glm::mix(f10 - f00, f11 - f01, y.t),
                               glm::mix(f01 - f00, f11 - f10, x.t));
        const Vector2 size(texels_.width(), texels_.height());
        return to_uv_.pull_back(by_texel * size);
    }

    Color mean() const override { return mean_; }
    float max() const override { return max_; }

private:
    struct Place {
        Between x, y;
    };

    Place place(Vector2 uv) const {
        const Vector2 p = to_uv_(uv);
        return {between(p.x, texels_.width(), wrap_, nearest_),
                between(p.y, texels_.height(), wrap_, nearest_)};
    }

    float number(Color c) const { return raw_ || texels_.channels() == 1 ? c.x : luminance(c); }

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
