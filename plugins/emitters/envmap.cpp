// SPDX-License-Identifier: Apache-2.0
/// envmap: light from all around, given by a picture of the whole sphere.
///
/// The picture holds longitude and latitude: +y is its upper edge, −z its left and right edges, +x
/// lies a quarter of the width from the left (Mitsuba's convention). Texels are interpolated
/// bilinearly, across the left and right edges, too.
/// sphere_map.h has the formulas.
///
/// p is constant in each texel and proportional to the luminance that the interpolation has there
/// on average, times sin θ: so it is positive wherever the light is. Large pictures are many lights
/// (map_patches.h); p is then that of the light's patch.
#include "plugins/emitters/map_patches.h"
#include "plugins/emitters/map_texels.h"
#include "plugins/emitters/scene_sphere.h"
#include "plugins/emitters/sphere_map.h"

#include "core/image/color.h"
#include "core/image/read_image.h"
#include "core/interfaces/emitter.h"
#include "core/math/orientation.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

class EnvironmentMap final : public Emitter {
public:
    explicit EnvironmentMap(const Params& params) {
        const auto path = params.file("filename", "picture of the sphere, 2:1");
        scale_ = params.real("scale", 1, non_negative, "factor of its radiance");
        const Transform to_world = params.transform("to_world", "turns the map; +y is up in it");
        params.no_effect("mis_compensation", "the map is sampled in proportion to its luminance");
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
        const std::optional<Frame> frame = orientation(to_world);
        if (!frame) params.error("to_world", "\"to_world\" of an envmap must not stretch space");
        world_from_map_ = frame.value_or(Frame());

        Image image = read_image(path);
        if (!image.notice.empty()) {
            params.warning("filename", fmt::format("{}: {}", path.string(), image.notice));
        }
        ColorConfig().to_rendering(image);
        const std::size_t bad = take_texels(image);
        if (bad > 0) {
            params.warning("filename",
                           fmt::format("{}: {} of {} texels are negative or not finite; such "
                                       "values are taken as 0",
                                       path.string(), bad, image.pixel_count()));
        }
        build_table();
    }

    void prepare(const Scene& scene) override { sphere_ = SceneSphere(scene); }

    bool infinite() const override { return true; }

    Color environment(Vector3 d) const override {
        return lookup(map_point(world_from_map_.to_local(d)).uv);
    }

    std::uint32_t light_count() const override { return patches_.size(); }
    std::uint32_t primitive_along(Vector3 d) const override {
        return patches_.at(map_point(world_from_map_.to_local(d)).uv);
    }

    std::optional<LightSample> sample_li(const Light& light, const Receiver&,
                                         Vector2 u) const override {
        const auto [uv, d, pdf] = sample_map(patches_, light.primitive, world_from_map_, u);
        if (!(pdf > 0)) return {};
        return LightSample{.wi = d, .distance = infinity, .radiance = lookup(uv), .pdf = pdf};
    }

    float pdf_li(const Light& light, const Receiver&, Vector3 wi,
                 const Interaction*) const override {
        return map_pdf(patches_, light.primitive, world_from_map_, wi);
    }

    std::optional<EmissionSample> sample_emission(const Light& light, Vector2 u_position,
                                                  Vector2 u_direction) const override {
        const auto [uv, d, pdf] =
            sample_map(patches_, light.primitive, world_from_map_, u_direction);
        if (!(pdf > 0)) return {};
        const float area = sphere_.cross_section();
        return EmissionSample{.ray = {.o = sphere_.ray_origin(-d, u_position), .d = -d},
                              .power = lookup(uv) * (area / pdf),
                              .pdf_position = 1 / area,
                              .pdf_direction = pdf};
    }

    LightBounds bounds(const Light& light) const override {
        return {.box = {},
                .directions = map_directions(patches_, light.primitive, world_from_map_),
                .power =
                    static_cast<double>(sphere_.cross_section()) * patches_.power(light.primitive)};
    }

private:
    /// Copies the colours; returns the number of texels that cannot be. Channels just below zero
    /// come from conversions between colour spaces.
    std::size_t take_texels(const Image& image) {
        constexpr float tolerance = 1e-5f;
        width_ = image.width;
        height_ = image.height;
        std::vector<Color> colors(image.pixel_count());
        std::size_t bad = 0;
        for (std::size_t i = 0; i < colors.size(); ++i) {
            const Color c = image.rgb(i);
            const bool finite = is_finite(scale_ * c);
            colors[i] = finite ? glm::max(c, Color(0)) : Color(0);
            bad += !finite || min_component(c) < -tolerance * max_component(absolute(c));
        }
        texels_ = MapTexels(colors, width_);
        return bad;
    }

    /// The weight of a texel is the flux through its solid angle of the interpolated map. The mean
    /// of a linear interpolation over a texel is 1/8, 6/8, 1/8 of its neighbours and of itself.
    void build_table() {
        std::vector<float> weights(static_cast<std::size_t>(width_) *
                                   static_cast<std::size_t>(height_));
        const double step = std::numbers::pi / height_;
        for (int y = 0; y < height_; ++y) {
            const int above = std::max(y - 1, 0), below = std::min(y + 1, height_ - 1);
            // cos θ₁ − cos θ₂ for the texel's upper and lower edge, times its width in φ.
            const double solid_angle = 2 * std::sin((y + 0.5) * step) * std::sin(0.5 * step) *
                                       (2 * std::numbers::pi / width_);
            const auto column = [&](int x) {
                return 0.125f * luminance(texel(x, above)) + 0.75f * luminance(texel(x, y)) +
                       0.125f * luminance(texel(x, below));
            };
            for (int x = 0; x < width_; ++x) {
                const int left = (x + width_ - 1) % width_, right = (x + 1) % width_;
                const float mean =
                    0.125f * column(left) + 0.75f * column(x) + 0.125f * column(right);
                weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(x)] =
                    static_cast<float>(static_cast<double>(mean) * solid_angle);
            }
        }
        patches_ = MapPatches(weights, width_, height_);
    }

    Color texel(int x, int y) const { return scale_ * to_vector3(texels_(x, y)); }

    /// Bilinear; periodic in u, constant beyond the centres of the first and last rows.
    Color lookup(Vector2 uv) const {
        const float x = uv.x * static_cast<float>(width_) - 0.5f;
        const float y = uv.y * static_cast<float>(height_) - 0.5f;
        const float left = std::floor(x), above = std::floor(y);
        const int x0 = left < 0 ? width_ - 1 : std::min(static_cast<int>(left), width_ - 1);
        const int x1 = x0 + 1 < width_ ? x0 + 1 : 0;
        const int y0 = std::clamp(static_cast<int>(above), 0, height_ - 1);
        const int y1 = std::clamp(static_cast<int>(above) + 1, 0, height_ - 1);
        const float s = x - left, t = y - above;
        const FourFloats upper = (1 - s) * texels_(x0, y0) + s * texels_(x1, y0);
        const FourFloats lower = (1 - s) * texels_(x0, y1) + s * texels_(x1, y1);
        return to_vector3(scale_ * ((1 - t) * upper + t * lower));
    }

    Frame world_from_map_;
    int width_ = 0, height_ = 0;
    float scale_ = 1;  ///< of the texels
    MapTexels texels_;
    MapPatches patches_;
    SceneSphere sphere_;
};

}  // namespace

const PluginInfo plugin = describe<EnvironmentMap>("a picture of the light all around");

}  // namespace lucerna
