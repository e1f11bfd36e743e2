// SPDX-License-Identifier: Apache-2.0
#include "core/scene/medium_tracking.h"

#include <algorithm>

namespace lucerna {

namespace {

float sum(Color c) { return c.x + c.y + c.z; }

/// ε ∫ exp(−σ t) dt from 0 to `length`.
Color emitted(Color emission, Color sigma, float length) {
    Color result(0);
    for (int c = 0; c < 3; ++c) {
        if (!(emission[c] > 0)) continue;  // the length may be infinite
        const float seen = sigma[c] > 0 ? -std::expm1(-sigma[c] * length) / sigma[c] : length;
        result[c] = emission[c] * seen;
    }
    return result;
}

/// The distance to the next of events that happen at a rate. 1 − u is exact.
float sample_distance(double u, float rate) {
    return static_cast<float>(-std::log(1 - u) / static_cast<double>(rate));
}

/// As fine as needed for media so thin that hardly any path collides.
double fine(float u, Rng& rng) {
    return static_cast<double>(u) + static_cast<double>(rng.next_float()) * 0x1p-24;
}

bool collide_homogeneous(const MediumSegment& segment, bool may_scatter, Vector2 u, Rng& rng,
                         MediumPath& path) {
    const MediumPoint m = segment.medium->at(segment.o, segment.d);
    if (segment.medium->emits()) {
        path.radiance += path.beta * emitted(m.emission, m.sigma_t, segment.length);
    }
    if (!may_scatter || is_black(m.sigma_s)) {
        path.beta *= attenuation(m.sigma_t, segment.length);
        return false;
    }
    const float total = sum(path.beta);
    if (!(total > 0)) return false;
    const Color share = path.beta / total;
    const int channel = u.x < share.x ? 0 : u.x < share.x + share.y ? 1 : 2;
    const float t =
        m.sigma_t[channel] > 0 ? sample_distance(fine(u.y, rng), m.sigma_t[channel]) : infinity;
    const bool grey = is_grey(m.sigma_t);  // then the attenuation cancels out
    if (t < segment.length) {
        const Color arriving = grey ? Color(1) : attenuation(m.sigma_t, t);
        path.beta *= m.sigma_s * arriving / sum(share * m.sigma_t * arriving);
        path.t = t;
        return true;
    }
    if (grey) return false;
    const Color arriving = attenuation(m.sigma_t, segment.length);
    path.beta *= arriving / sum(share * arriving);
    return false;
}

/// Visits collisions of light with the medium and with what fills it up to its majorants, in order,
/// until `visit(t, point, majorant)` says to stop.
template <typename Visit>
void track(const MediumSegment& segment, Rng& rng, const Visit& visit) {
    const Medium& medium = *segment.medium;
    MajorantIterator parts(*medium.majorants(), segment.o, segment.d, segment.length);
    while (const auto part = parts.next()) {
        float t = part->begin;
        while (true) {
            t += sample_distance(rng.next_double(), part->majorant);
            if (!(t < part->end)) break;
            if (visit(t, medium.at(segment.o + t * segment.d, segment.d), part->majorant)) return;
        }
    }
}

bool collide_tracked(const MediumSegment& segment, bool may_scatter, Rng& rng, MediumPath& path) {
    bool scattered = false;
    track(segment, rng, [&](float t, const MediumPoint& m, float majorant) {
        path.radiance += path.beta * m.emission / majorant;
        const Color null = glm::max(Color(majorant) - m.sigma_t, Color(0));
        const float real_rate = may_scatter ? sum(path.beta * m.sigma_s) : 0.0f;
        const float null_rate = sum(path.beta * null);
        const float real_share = real_rate / (real_rate + null_rate);
        if (!(real_rate + null_rate > 0)) {
            path.beta = Color(0);
            return true;
        }
        if (rng.next_float() < real_share) {
            path.beta *= m.sigma_s / (majorant * real_share);
            path.t = t;
            scattered = true;
            return true;
        }
        path.beta *= null / (majorant * (1 - real_share));
        return false;
    });
    return scattered;
}

/// One step of ratio tracking; true if nothing is left.
bool attenuate(const MediumPoint& m, float majorant, Rng& rng, Color& result) {
    result *= glm::max(Color(1) - m.sigma_t / majorant, Color(0));
    // Russian roulette: the rest of the way costs more than it tells.
    constexpr float dim = 0.1f, survival = 0.5f;
    if (max_component(result) >= dim) return false;
    const bool ends = is_black(result) || !(rng.next_float() < survival);
    result = ends ? Color(0) : result / survival;
    return ends;
}

}  // namespace

Color transmittance(const MediumSegment& segment, Rng& rng) {
    if (!segment.medium) return Color(1);
    const Medium& medium = *segment.medium;
    if (medium.homogeneous())
        return attenuation(medium.at(segment.o, segment.d).sigma_t, segment.length);
    Color result(1);
    track(segment, rng, [&](float, const MediumPoint& m, float majorant) {
        return attenuate(m, majorant, rng, result);
    });
    return result;
}

TransmittanceAlong::TransmittanceAlong(const MediumSegment& segment, Rng& rng)
    : homogeneous_(segment.medium->homogeneous()) {
    if (homogeneous_) {
        sigma_t_ = segment.medium->at(segment.o, segment.d).sigma_t;
        return;
    }
    steps_.push_back({0, Color(1)});
    Color now(1);
    track(segment, rng, [&](float t, const MediumPoint& m, float majorant) {
        const bool ends = attenuate(m, majorant, rng, now);
        steps_.push_back({t, now});
        return ends;
    });
}

Color TransmittanceAlong::operator()(float t) const {
    if (homogeneous_) return attenuation(sigma_t_, t);
    const auto next = std::upper_bound(steps_.begin() + 1, steps_.end(), t,
                                       [](float x, const Step& step) { return x < step.t; });
    return (next - 1)->transmittance;
}

bool sample_collision(const MediumSegment& segment, bool may_scatter, Vector2 u, Rng& rng,
                      MediumPath& path) {
    if (!segment.medium) return false;
    return segment.medium->homogeneous() ? collide_homogeneous(segment, may_scatter, u, rng, path)
                                         : collide_tracked(segment, may_scatter, rng, path);
}

}  // namespace lucerna
