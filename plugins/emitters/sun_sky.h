// SPDX-License-Identifier: Apache-2.0
/// What `sunsky`, `sky` and `sun` share: a clear sky around the scene, dark below the horizon, and
/// the sun in it. In the emitter's own space +z is up, as in Mitsuba.
///
/// The sky is sampled through a table (map_patches.h) whose texels hold the flux of the model,
/// which itself is evaluated exactly. The sun is one more light, a cone that is sampled uniformly;
/// the sky in front of it belongs to it, so that each direction is of one light.
#pragma once

#include "plugins/emitters/scene_sphere.h"
#include "plugins/emitters/sky_model.h"
#include "plugins/emitters/sphere_map.h"
#include "plugins/emitters/sun_position.h"

#include "core/interfaces/emitter.h"
#include "core/math/orientation.h"

namespace lucerna {

class SunSky : public Emitter {
public:
    void prepare(const Scene& scene) override { sphere_ = SceneSphere(scene); }

    bool infinite() const override { return true; }
    std::uint32_t light_count() const override { return sky_lights() + (has_sun_ ? 1 : 0); }
    std::uint32_t primitive_along(Vector3 d) const override {
        if (in_sun(d) || sky_lights() == 0) return sky_lights();
        return patches_.at(map_point(world_from_map_.to_local(d)).uv);
    }

    Color environment(Vector3 d) const override {
        const float cos_theta = world_from_map_.to_local(d).y;
        if (!(cos_theta >= 0)) return Color(0);
        Color radiance(0);
        if (sky_scale_ > 0) radiance += sky_scale_ * model_.sky(cos_theta, glm::dot(d, sun_));
        if (in_sun(d)) radiance += sun_radiance_;
        return radiance;
    }

    std::optional<LightSample> sample_li(const Light& light, const Receiver&,
                                         Vector2 u) const override {
        const auto [d, radiance, pdf] = sample_direction(light.primitive, u);
        if (!(pdf > 0)) return {};
        return LightSample{.wi = d, .distance = infinity, .radiance = radiance, .pdf = pdf};
    }

    float pdf_li(const Light& light, const Receiver&, Vector3 wi,
                 const Interaction*) const override {
        const bool sun = in_sun(wi);
        if (light.primitive == sky_lights()) return sun ? sun_pdf() : 0.0f;
        return sun ? 0.0f : map_pdf(patches_, light.primitive, world_from_map_, wi);
    }

    std::optional<EmissionSample> sample_emission(const Light& light, Vector2 u_position,
                                                  Vector2 u_direction) const override {
        const auto [d, radiance, pdf] = sample_direction(light.primitive, u_direction);
        if (!(pdf > 0)) return {};
        const float area = sphere_.cross_section();
        return EmissionSample{.ray = {.o = sphere_.ray_origin(-d, u_position), .d = -d},
                              .power = radiance * (area / pdf),
                              .pdf_position = 1 / area,
                              .pdf_direction = pdf};
    }

    LightBounds bounds(const Light& light) const override {
        const double area = static_cast<double>(sphere_.cross_section());
        if (light.primitive < sky_lights()) {
            return {.box = {},
                    .directions = map_directions(patches_, light.primitive, world_from_map_),
                    .power = area * patches_.power(light.primitive)};
        }
        // The sky before the sun is counted among the sky's.
        const Vector3 margin(std::sqrt(sin2_sun_) + 1e-6f);
        return {.box = {},
                .directions = {.min = sun_ - margin, .max = sun_ + margin},
                .power = area * static_cast<double>(luminance(sun_radiance_) / sun_pdf())};
    }

protected:
    /// With or without the sky and the sun, whose factors are these parameters.
    SunSky(const Params& params, const char* sky_scale, const char* sun_scale) {
        const double turbidity = static_cast<double>(params.real(
            "turbidity", 3, {.min = 1, .max = 10}, "haze: 1 is pure air, 10 a hazy day"));
        Color albedo(0);
        if (sky_scale) {
            albedo = params.rgb("albedo", Color(0.3f), unit_interval, "reflectance of the ground");
            sky_scale_ = params.real(sky_scale, 1, non_negative, "factor of the sky's radiance");
        }
        place(params);
        const double elevation = std::asin(
            std::clamp(static_cast<double>(glm::dot(sun_, world_from_map_.t)), -1.0, 1.0));
        if (elevation < 0) {
            params.warning("sun_direction", "the sun is below the horizon: it is dark");
        }
        model_ = SkyModel(turbidity, albedo, elevation);
        if (sun_scale) read_sun(params, sun_scale);
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
        build_table();
    }

private:
    struct DirectionSample {
        Vector3 d{0};  ///< towards the light
        Color radiance{0};
        float pdf = 0;  ///< [1/sr]; 0: none
    };

    void read_sun(const Params& params, const char* scale) {
        constexpr float degree = pi / 180;
        const float sun = params.real(scale, 1, non_negative, "factor of the sun's radiance");
        const float aperture = params.real(
            "sun_aperture", 0.5358, {.min = 0, .max = 90, .open_min = true, .open_max = true},
            "width of the sun [°]; its irradiance stays the same");
        if (params.boolean("complex_sun", false, "a sun with a dark limb, which there is not")) {
            params.error("complex_sun",
                         "the sun is equally bright all over; use a wider "
                         "\"sun_aperture\" for softer shadows");
        }
        one_minus_cos_ = 2 * sqr(std::sin(aperture * degree / 4));
        sin2_sun_ = sqr(std::sin(aperture * degree / 2));
        const float seen = 2 * sqr(std::sin(0.5358f * degree / 4));
        sun_radiance_ = sun * (seen / one_minus_cos_) * model_.sun();
        has_sun_ = !is_black(sun_radiance_);
    }

    /// None if there is only the sun; one at least if there is nothing.
    std::uint32_t sky_lights() const { return sky_scale_ > 0 || !has_sun_ ? patches_.size() : 0; }
    float sun_pdf() const { return square_to_uniform_cone_pdf(one_minus_cos_); }

    /// By the cross product: cosines of small angles have no digits left.
    bool in_sun(Vector3 d) const {
        const Vector3 across = glm::cross(d, sun_);
        return has_sun_ && glm::dot(across, across) <= sin2_sun_ && glm::dot(d, sun_) > 0;
    }

    DirectionSample sample_direction(std::uint32_t primitive, Vector2 u) const {
        if (primitive == sky_lights()) {
            const Vector3 local = square_to_uniform_cone(u, one_minus_cos_);
            const Vector3 d = Frame::from_normal(sun_).to_world(local);
            const Color radiance = environment(d);
            // Rounding may put a direction beyond the edge.
            return {d, radiance, in_sun(d) && !is_black(radiance) ? sun_pdf() : 0.0f};
        }
        const MapSample at = sample_map(patches_, primitive, world_from_map_, u);
        if (!(at.pdf > 0) || in_sun(at.d)) return {};
        return {at.d, environment(at.d), at.pdf};
    }

    /// Reads the orientation of the sky, and where the sun stands in it.
    void place(const Params& params) {
        const Transform to_world = params.transform("to_world", "turns the sky; +z is up in it");
        const std::optional<Frame> frame = orientation(to_world);
        if (!frame) params.error("to_world", "\"to_world\" of a sky must not stretch space");
        const Frame sky = frame.value_or(Frame());
        world_from_map_ = {sky.s, sky.n, -sky.t};

        const PlaceAndTime when{
            .latitude = static_cast<double>(
                params.real("latitude", 35.6894, {.min = -90, .max = 90}, "[°], north")),
            .longitude = static_cast<double>(
                params.real("longitude", 139.6917, {.min = -360, .max = 360}, "[°], east")),
            .timezone = static_cast<double>(
                params.real("timezone", 9, {.min = -24, .max = 24}, "hours ahead of UTC")),
            .year = params.int32("year", 2010, {.min = -4000, .max = 10000}, "of the date"),
            .month = params.int32("month", 7, {.min = 1, .max = 12}, "of the date"),
            .day = params.int32("day", 10, {.min = 1, .max = 31}, "of the date"),
            .hour = read_hour(params)};
        const Vector3 direction = params.vector(
            "sun_direction", Vector3(0),
            "towards the sun, in the world; instead of a place and a time, from which it follows");
        if (!params.has("sun_direction")) {
            sun_ = sky.to_world(glm::normalize(Vector3(sun_position(when))));
            return;
        }
        for (const char* name : {"latitude", "longitude", "timezone", "year", "month", "day",
                                 "hour", "minute", "second"}) {
            if (!params.has(name)) continue;
            params.error("sun_direction",
                         "give either sun_direction, or a place and a time, not both");
        }
        if (!(glm::length(direction) > 0)) {
            params.error("sun_direction", "the direction must not be zero");
            return;
        }
        sun_ = glm::normalize(direction);
    }

    static double read_hour(const Params& params) {
        constexpr Range hours{.min = 0, .max = 24}, sixtieths{.min = 0, .max = 60};
        const double hour = static_cast<double>(params.real("hour", 15, hours, "of the clock"));
        const double minute = static_cast<double>(params.real("minute", 0, sixtieths, "as well"));
        const double second = static_cast<double>(params.real("second", 0, sixtieths, "as well"));
        return hour + (minute + second / 60) / 60;
    }

    /// The weight of a texel is the flux through its solid angle, by two by two points. Half of the
    /// rows are above the horizon.
    void build_table() {
        constexpr int width = 256, height = 128;
        std::vector<float> weights(std::size_t{width} * height);
        constexpr std::array<float, 2> points = {0.2113249f, 0.7886751f};  // Gauss
        for (int y = 0; sky_scale_ > 0 && y < height / 2; ++y) {
            for (int x = 0; x < width; ++x) {
                float sum = 0;
                for (const float v : points) {
                    for (const float u : points) {
                        float sin_theta = 0;
                        const Vector2 uv((static_cast<float>(x) + u) / width,
                                         (static_cast<float>(y) + v) / height);
                        const Vector3 d = map_direction(uv, sin_theta);
                        const float cos_gamma = glm::dot(world_from_map_.to_world(d), sun_);
                        sum += luminance(model_.sky(d.y, cos_gamma)) * sin_theta;
                    }
                }
                weights[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
                    sky_scale_ * sum / 4 * (2 * pi / width) * (pi / height);
            }
        }
        patches_ = MapPatches(weights, width, height);
    }

    Frame world_from_map_;  ///< +y of the map is up
    Vector3 sun_{0, 0, 1};  ///< towards it, in the world
    SkyModel model_;
    float sky_scale_ = 0;
    Color sun_radiance_{0};
    bool has_sun_ = false;
    float one_minus_cos_ = 0, sin2_sun_ = 0;  ///< of half the angle of the sun
    MapPatches patches_;
    SceneSphere sphere_;
};

}  // namespace lucerna
