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
#include "plugins/emitters/scene_sphere.h"
#include "plugins/emitters/sphere_map.h"

#include "core/image/color.h"
#include "core/image/read_image.h"
#include "core/image/texels.h"
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
        const std::size_t bad = clean(image);
        if (bad > 0) {
            params.warning("filename",
                           fmt::format("{}: {} of {} texels are negative or not finite; such "
                                       "values are taken as 0",
                                       path.string(), bad, image.pixel_count()));
        }
        texels_ = Texels(std::move(image), true);
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
    /// Sets to zero what cannot be radiance; returns the number of such texels. Channels just below
    /// zero come from conversions between colour spaces.
    std::size_t clean(Image& image) const {
        constexpr float tolerance = 1e-5f;
        std::size_t bad = 0;
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Color c = image.rgb(x, y);
                const bool finite = is_finite(scale_ * c);
                bad += !finite || min_component(c) < -tolerance * max_component(absolute(c));
                if (!finite || min_component(c) < 0) {
                    image.set_rgb(x, y, finite ? glm::max(c, Color(0)) : Color(0));
                }
            }
        }
        return bad;
    }

    /// The weight of a texel is the flux through its solid angle of the interpolated map. The mean
    /// of a linear interpolation over a texel is 1/8, 6/8, 1/8 of its neighbours and of itself.
    void build_table() {
        const int width = texels_.width(), height = texels_.height();
        std::vector<float> weights(static_cast<std::size_t>(width) *
                                   static_cast<std::size_t>(height));
        const double step = std::numbers::pi / height;
        for (int y = 0; y < height; ++y) {
            const int above = std::max(y - 1, 0), below = std::min(y + 1, height - 1);
            // cos θ₁ − cos θ₂ for the texel's upper and lower edge, times its width in φ.
            const double solid_angle = 2 * std::sin((y + 0.5) * step) * std::sin(0.5 * step) *
                                       (2 * std::numbers::pi / width);
            const auto column = [&](int x) {
                return 0.125f * luminance(texel(x, above)) + 0.75f * luminance(texel(x, y)) +
                       0.125f * luminance(texel(x, below));
            };
            for (int x = 0; x < width; ++x) {
                const int left = (x + width - 1) % width, right = (x + 1) % width;
                const float mean =
                    0.125f * column(left) + 0.75f * column(x) + 0.125f * column(right);
                weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(x)] =
                    static_cast<float>(static_cast<double>(mean) * solid_angle);
            }
        }
        patches_ = MapPatches(weights, width, height);
    }

    Color texel(int x, int y) const { return scale_ * texels_(x, y); }

    /// Bilinear; periodic in u, constant beyond the centres of the first and last rows.
    Color lookup(Vector2 uv) const {
        const int width = texels_.width(), height = texels_.height();
        const float x = uv.x * static_cast<float>(width) - 0.5f;
        const float y = uv.y * static_cast<float>(height) - 0.5f;
        const float left = std::floor(x), above = std::floor(y);
        const int x0 = left < 0 ? width - 1 : std::min(static_cast<int>(left), width - 1);
        const int x1 = x0 + 1 < width ? x0 + 1 : 0;
        const int y0 = std::clamp(static_cast<int>(above), 0, height - 1);
        const int y1 = std::clamp(static_cast<int>(above) + 1, 0, height - 1);
        const float s = x - left, t = y - above;
        const std::size_t columns[] = {texels_.column(x0), texels_.column(x1)};
        const auto in_row = [&](int row) {
            const std::size_t place = texels_.row(row);
            return (1 - s) * texels_.at(columns[0] + place) + s * texels_.at(columns[1] + place);
        };
        return to_vector3(scale_ * ((1 - t) * in_row(y0) + t * in_row(y1)));
    }

    Frame world_from_map_;
    float scale_ = 1;  ///< what texels are multiplied by
    Texels texels_;
    MapPatches patches_;
    SceneSphere sphere_;
};

}  // namespace

const PluginInfo plugin = describe<EnvironmentMap>("a picture of the light all around");

}  // namespace lucerna
