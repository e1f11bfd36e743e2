// SPDX-License-Identifier: Apache-2.0
/// A second way to choose where a homogeneous medium scatters direct light along a ray: near the
/// light instead of near the camera.
///
/// With a point y on a light, at distance D from the ray and next to it at t = δ, half of the
/// distances have the equiangular density (Kulla and Fajardo 2012)
///
///     D / ((θb − θa) (D² + (t − δ)²))          θ = atan((t − δ) / D), at both ends
///
/// which undoes the square of the distance to y, and half the density of collisions before the end
/// of the ray. y does not depend on the distances that are weighted against each other.
#pragma once

#include "core/scene/medium_tracking.h"

#include <optional>

namespace lucerna {

class LineScattering {
public:
    /// For a path of throughput `beta` that enters the segment; its end may be at infinity.
    LineScattering(const MediumSegment& segment, Color beta)
        : segment_(segment), point_(segment.medium->at(segment.o, segment.d)), beta_(beta) {
        const float total = beta.x + beta.y + beta.z;
        rate_ =
            (beta.x * point_.sigma_t.x + beta.y * point_.sigma_t.y + beta.z * point_.sigma_t.z) /
            total;
        reach_ = 1 - std::exp(-static_cast<double>(rate_) * static_cast<double>(segment.length));
        share_ = beta / total;
    }

    /// Whether anything is scattered at all.
    bool scatters() const { return !is_black(point_.sigma_s) && reach_ > 0; }

    /// A distance at which the medium would scatter, if it must before the end of the segment.
    float forced_distance(double u) const {
        const double t = -std::log(1 - u * reach_) / static_cast<double>(rate_);
        return std::min(static_cast<float>(t), segment_.length);
    }

    /// The point on a light near which half of the distances are chosen.
    void aim_at(Vector3 y) {
        const Vector3 to = y - segment_.o;
        const float delta = glm::dot(to, segment_.d);
        const float distance = glm::length(to - delta * segment_.d);
        const float begin = std::atan(-delta / distance);
        const float angle = std::atan((segment_.length - delta) / distance) - begin;
        if (!(distance > 0) || !(angle > 1e-6f)) return;
        delta_ = delta, distance_ = distance, begin_ = begin, angle_ = angle;
    }

    /// A distance; both numbers in [0, 1).
    float sample(float u_strategy, double u) const {
        if (!(distance_ > 0) || u_strategy < 0.5f) return forced_distance(u);
        const float angle = begin_ + static_cast<float>(u) * angle_;
        return std::clamp(delta_ + distance_ * std::tan(angle), 0.0f, segment_.length);
    }
    /// The share of the path's own collision at t in an estimate of the direct light there.
    float collision_weight(float t) const {
        const Color arriving = attenuation(point_.sigma_t, t);
        const float own = collision_pdf(arriving);
        return own > 0 ? own / (own + pdf(t, arriving)) : 0.0f;
    }
    /// The throughput up to and with a scattering at t that `sample` has chosen.
    Color throughput_alone(float t) const {
        const Color arriving = attenuation(point_.sigma_t, t);
        return beta_ * point_.sigma_s * arriving / pdf(t, arriving);
    }
    /// The same, weighted against the path's own collision.
    Color throughput(float t) const {
        const Color arriving = attenuation(point_.sigma_t, t);
        return beta_ * point_.sigma_s * arriving / (collision_pdf(arriving) + pdf(t, arriving));
    }

private:
    /// The density of `sample` at t, up to which the attenuation is `arriving` [1/m].
    float pdf(float t, Color arriving) const {
        const float thinned = is_grey(point_.sigma_t) ? arriving.x : std::exp(-rate_ * t);
        const float forced = rate_ * thinned / static_cast<float>(reach_);
        if (!(distance_ > 0)) return forced;
        const float off = t - delta_;
        const float near = distance_ / (angle_ * (distance_ * distance_ + off * off));
        return 0.5f * (forced + near);
    }
    /// The density with which a path collides by itself where so much arrives
    /// (medium_tracking.h) [1/m].
    float collision_pdf(Color arriving) const {
        const Color density = share_ * point_.sigma_t * arriving;
        return density.x + density.y + density.z;
    }

    MediumSegment segment_;
    MediumPoint point_;
    Color beta_, share_;
    float rate_ = 0;    ///< mean of the extinction over the throughput [1/m]
    double reach_ = 0;  ///< share of collisions at this rate before the end
    float delta_ = 0, distance_ = 0, begin_ = 0, angle_ = 0;
};

}  // namespace lucerna
