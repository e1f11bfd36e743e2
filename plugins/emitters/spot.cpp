// SPDX-License-Identifier: Apache-2.0
/// spot: light from a point within a cone around its z axis.
///
/// The intensity is I up to the angle b (beam_width), falls linearly in the angle to zero at c
/// (cutoff_angle), and is multiplied by a texture that is projected along the axis: the square
/// [0, 1]² of the texture holds the cone, u grows along local x and v against local y, as in
/// Mitsuba. Seen along the axis with y down, a picture is upright. Without a texture
///
///   Φ = 2π I (1 − (sin c − sin b) / (c − b)),   which is 2π I (1 − cos c) for b = c.
#include "core/math/orientation.h"
#include "core/math/warp.h"
#include "plugins/emitters/light_point.h"

namespace lucerna {

namespace {

constexpr double radians = std::numbers::pi / 180;

/// 1 − (sin c − sin b) / (c − b), the mean of 1 − cos over [b, c], without cancellation.
double mean_one_minus_cos(double b, double c) {
    const double middle = 0.5 * (c + b), half = 0.5 * (c - b);
    const double one_minus_sinc =
        half < 1e-2 ? half * half / 6 * (1 - half * half / 20) : 1 - std::sin(half) / half;
    return 2 * sqr(std::sin(0.5 * middle)) + std::cos(middle) * one_minus_sinc;
}

class SpotEmitter final : public LightPoint {
public:
    explicit SpotEmitter(const Params& params)
        : LightPoint(params),
          intensity_(params.rgb("intensity", Color(1), non_negative,
                                "radiant intensity along the axis [W/sr]")) {
        const double cutoff =
            static_cast<double>(params.real("cutoff_angle", 20, {.min = 0, .max = 180},
                                            "angle to the axis at which the light ends [degrees]"));
        const double beam = static_cast<double>(
            params.real("beam_width", 0.75 * cutoff, {.min = 0, .max = 180},
                        "angle up to which it is not attenuated: by default 3/4 of cutoff_angle"));
        texture_ = params.child<Texture>("texture", "projected along the axis");
        const Transform to_world =
            params.transform("to_world", "moves the light from 0 and turns it from the z axis");
        params.no_effect("sampling_weight", "lights are chosen by the light_sampler");
        if (beam > cutoff) params.error("beam_width", "beam_width is larger than cutoff_angle");
        if (texture_ && cutoff >= 90) {
            params.error("texture", "a texture needs a cutoff_angle below 90 degrees");
        }
        const std::optional<Frame> frame = orientation(to_world);
        if (!frame) params.error("to_world", "\"to_world\" of a spot must not stretch space");
        frame_ = frame.value_or(Frame());
        position_ = Vector3(to_world.point(Vector3d(0)));
        set_cone(beam * radians, cutoff * radians);
    }

    std::optional<EmissionSample> sample_emission(const Light&, Vector2,
                                                  Vector2 u_direction) const override {
        if (!(one_minus_cos_cutoff_ > 0)) return {};
        const Vector3 local = square_to_uniform_cone(u_direction, one_minus_cos_cutoff_);
        const float pdf = square_to_uniform_cone_pdf(one_minus_cos_cutoff_);
        return EmissionSample{.ray = {.o = position_, .d = frame_.to_world(local)},
                              .power = local_intensity(local) / pdf,
                              .pdf_position = 1,
                              .pdf_direction = pdf};
    }

    LightBounds bounds(const Light&) const override {
        const Color mean = texture_ ? intensity_ * texture_->mean() : intensity_;
        return {.box = {.min = position_, .max = position_},
                .axis = frame_.n,
                .cos_normals = std::cos(beam_),
                .cos_emission = std::cos(cutoff_ - beam_),
                .power = 2 * std::numbers::pi * mean_one_minus_cos_ *
                         static_cast<double>(luminance(mean))};
    }

private:
    void set_cone(double beam, double cutoff) {
        beam_ = static_cast<float>(beam);
        cutoff_ = static_cast<float>(cutoff);
        one_minus_cos_cutoff_ = static_cast<float>(2 * sqr(std::sin(0.5 * cutoff)));
        mean_one_minus_cos_ = mean_one_minus_cos(beam, cutoff);
        texture_scale_ = static_cast<float>(0.5 / std::tan(cutoff));
    }

    Color intensity(Vector3 w) const override { return local_intensity(frame_.to_local(w)); }

    /// Along the local unit vector `w` [W/sr].
    Color local_intensity(Vector3 w) const {
        const float angle = std::atan2(std::sqrt(sin2_theta(w)), w.z);
        if (angle >= cutoff_) return Color(0);
        const float falloff = angle <= beam_ ? 1 : (cutoff_ - angle) / (cutoff_ - beam_);
        if (!texture_) return falloff * intensity_;
        const Vector2 uv(0.5f + texture_scale_ * w.x / w.z, 0.5f - texture_scale_ * w.y / w.z);
        return falloff * intensity_ * texture_->color(uv);
    }

    Color intensity_;
    const Texture* texture_ = nullptr;
    Frame frame_;
    float beam_ = 0, cutoff_ = 0;
    float one_minus_cos_cutoff_ = 0;
    float texture_scale_ = 0;
    double mean_one_minus_cos_ = 0;
};

}  // namespace

const PluginInfo plugin = describe<SpotEmitter>("light from a point within a cone");

}  // namespace lucerna
