// SPDX-License-Identifier: Apache-2.0
/// How media are given: by albedo and extinction (Mitsuba 3), or by scattering and absorption.
#pragma once

#include "core/interfaces/medium.h"
#include "core/interfaces/volume.h"

namespace lucerna {

/// The coefficients of a medium, constant or in space.
class MediumCoefficients {
public:
    explicit MediumCoefficients(const Params& params)
        : by_albedo_(!params.has("sigma_a") && !params.has("sigma_s")),
          first_(params.volume_input(
              by_albedo_ ? "albedo" : "sigma_s", Color(by_albedo_ ? 0.75f : 0.0f),
              by_albedo_ ? unit_interval : non_negative,
              by_albedo_ ? "share of the extinction that is scattering" : "scattering [1/m]")),
          second_(params.volume_input(by_albedo_ ? "sigma_t" : "sigma_a",
                                      Color(by_albedo_ ? 1.0f : 0.0f), non_negative,
                                      by_albedo_ ? "extinction [1/m]; or, instead of both, sigma_a "
                                                   "and sigma_s"
                                                 : "absorption [1/m]")),
          emission_(params.volume_input("emission", Color(0), non_negative,
                                        "emitted radiance for each unit of length [W/(m³ sr)]")),
          scale_(params.real("scale", 1, non_negative, "a factor of the extinction")) {
        for (const char* const name : {"albedo", "sigma_t"}) {
            if (by_albedo_ || !params.has(name)) continue;
            params.error(name, "give \"albedo\" and \"sigma_t\", or \"sigma_a\" and \"sigma_s\"");
            params.volume_input(name, Color(0), any_value, "");
        }
        params.no_effect("sample_emitters", "lights are sampled in all media");
        params.no_effect("has_spectral_extinction", "each channel has its own extinction");
        if (by_albedo_ && first_.volume && first_.max(first_.bounds()) > 1) {
            params.error("albedo", "\"albedo\" must be within [0, 1]; the volume reaches " +
                                       std::to_string(first_.max(first_.bounds())));
        }
    }

    MediumPoint at(Vector3 p) const {
        const Color first = first_.color(p), second = scale_ * second_.color(p);
        const Color emission = emits() ? emission_.color(p) : Color(0);
        if (by_albedo_) return {first * second, second, emission};
        return {scale_ * first, scale_ * first + second, emission};
    }
    bool emits() const { return emission_.volume || !is_black(emission_.constant); }
    /// The same at every point of the world.
    bool constant() const {
        const Bounds3 box = bounds();
        return resolution() == glm::ivec3(1) && box.min == Vector3(-infinity) &&
               box.max == Vector3(infinity);
    }
    /// Where extinction ends: Mitsuba asks `albedo` and `emission` beyond their own bounds, too. If
    /// extinction is everywhere, of all of them that vary; infinite where none ends.
    Bounds3 bounds() const {
        if (by_albedo_ && second_.volume) return second_.bounds();
        Bounds3 all{.min = Vector3(-infinity), .max = Vector3(infinity)};
        for (const VolumeInput* input : {&first_, &second_, &emission_}) {
            const Bounds3 box = input->bounds();
            all = {.min = glm::max(all.min, box.min), .max = glm::min(all.max, box.max)};
        }
        return all;
    }
    glm::ivec3 resolution() const {
        return glm::max(glm::max(first_.resolution(), second_.resolution()),
                        emission_.resolution());
    }
    /// Bounds the extinction in a box [1/m].
    float max_extinction(const Bounds3& box) const {
        return scale_ * (by_albedo_ ? second_.max(box) : first_.max(box) + second_.max(box));
    }
    float max_emission(const Bounds3& box) const { return emission_.max(box); }

private:
    bool by_albedo_;
    VolumeInput first_, second_;  ///< albedo and sigma_t, or sigma_s and sigma_a
    VolumeInput emission_;
    float scale_;
};

}  // namespace lucerna
