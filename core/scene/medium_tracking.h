// SPDX-License-Identifier: Apache-2.0
/// Light on its way through a medium: how much arrives, and where it is scattered.
///
/// Homogeneous media are sampled analytically, one channel chosen in proportion to the throughput
/// and all weighted by the balance heuristic. Others are tracked by tentative collisions at a rate
/// that bounds the extinction of all channels (Woodcock et al. 1965), and whether one is real is
/// decided by the throughput so far (Kutz et al. 2017, "history-aware"). In both, the sum of the
/// throughput's channels never grows, so that coloured media make no bright outliers.
#pragma once

#include "core/interfaces/medium.h"
#include "core/interfaces/shape.h"
#include "core/math/sequences.h"

#include <vector>

namespace lucerna {

/// The medium in which a path is that leaves `at` along `d`, and was in `current` before.
inline const Medium* medium_beyond(const Interaction& at, Vector3 d, const Medium* current) {
    const MediumInterface& media = at.shape->media();
    return media ? media.beyond(at.n, d) : current;
}

/// A part of a ray, o + t d with |d| = 1 and 0 <= t <= length, in one medium.
struct MediumSegment {
    const Medium* medium = nullptr;  ///< null: empty space
    Vector3 o{0}, d{0, 0, 1};
    float length = 0;  ///< may be infinite
};

/// Whether all channels are the same, as in the usual fog.
inline bool is_grey(Color c) { return c.x == c.y && c.y == c.z; }

/// exp(−σ t), where t may be infinite.
inline Color attenuation(Color sigma, float t) {
    const auto of = [t](float s) { return s > 0 ? std::exp(-s * t) : 1.0f; };
    return is_grey(sigma) ? Color(of(sigma.x)) : Color(of(sigma.x), of(sigma.y), of(sigma.z));
}

/// What happens to paths of the throughput `beta` on their way through a homogeneous medium.
class HomogeneousEdge {
public:
    /// From o along the unit vector d, so far as `length`.
    HomogeneousEdge(const Medium& medium, Vector3 o, Vector3 d, float length, Color beta)
        : point_(medium.at(o, d)), arriving_(attenuation(point_.sigma_t, length)) {
        share_ = beta / (beta.x + beta.y + beta.z);
    }

    /// The fraction of light that gets to the end; if it is scattered there, times scattering
    /// [1/m].
    Color weight(bool scattered) const {
        return scattered ? point_.sigma_s * arriving_ : arriving_;
    }
    /// The density of collisions at the end [1/m]; if it is not scattered there, the probability
    /// to get there.
    float reach(bool scattered) const {
        if (scattered) return glm::dot(share_, point_.sigma_t * arriving_);
        return is_black(point_.sigma_s) ? 1.0f : glm::dot(share_, arriving_);
    }

private:
    MediumPoint point_;
    Color arriving_, share_;
};

/// An unbiased estimate of the fraction of light that gets through: exact in homogeneous media, by
/// ratio tracking (Novák et al. 2014) in others.
Color transmittance(const MediumSegment& segment, Rng& rng);

/// An unbiased estimate of the transmittance up to every point of a segment that has a medium:
/// exact in homogeneous media, one run of ratio tracking in others.
class TransmittanceAlong {
public:
    TransmittanceAlong(const MediumSegment& segment, Rng& rng);
    /// Up to o + t d, 0 <= t <= length.
    Color operator()(float t) const;

private:
    /// From t on, up to the next step.
    struct Step {
        float t;
        Color transmittance;
    };
    bool homogeneous_;
    Color sigma_t_{0};
    std::vector<Step> steps_;
};

/// A path in a medium, and what its camera sees of the medium's emission.
struct MediumPath {
    Color beta{1};      ///< throughput
    Color radiance{0};  ///< emission on the way, times the throughput there
    float t = 0;        ///< where it is scattered, if it is
};

/// Follows a path to where it is scattered: true, and beta has the factor σs T / pdf. Or to the end
/// of the segment: false, and the factor is T / pdf. Unless it `may_scatter`, always to the end. A
/// path of which nothing is left ends anywhere, with a throughput of zero. u in [0, 1)² chooses the
/// channel and the distance in homogeneous media.
bool sample_collision(const MediumSegment& segment, bool may_scatter, Vector2 u, Rng& rng,
                      MediumPath& path);

}  // namespace lucerna
