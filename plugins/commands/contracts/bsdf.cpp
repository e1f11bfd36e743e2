// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/bsdf.h"

#include "core/math/warp.h"

#include <fmt/format.h>

namespace lucerna::contracts {

namespace {

std::string text(Vector3 w) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", w.x, w.y, w.z); }

/// Equal to within `tolerance` of the larger.
bool close(Color a, Color b, float tolerance) {
    const float difference = max_component(absolute(a - b));
    return difference <= tolerance * max_component(glm::max(absolute(a), absolute(b))) + 1e-7f;
}

/// A pair of directions, half of them with the second one sampled; the cosines are not so small
/// that the rounding of directions decides.
std::optional<std::pair<Vector3, Vector3>> directions(const BSDF& bsdf, const Interaction& at,
                                                      bool sampled, Rng& rng) {
    const Vector3 a = square_to_uniform_sphere(rng.next_float2());
    Vector3 b = square_to_uniform_sphere(rng.next_float2());
    if (sampled) {
        const auto s = draw(bsdf, at, a, transport_modes[0], rng);
        if (s) b = s->wi;
    }
    if (std::min(std::abs(a.z), std::abs(b.z)) < 1e-3f) return {};
    return std::pair(a, b);
}

bool is_sound(Color c) { return is_finite(c) && min_component(c) >= 0; }

}  // namespace

Interaction bsdf_surface() {
    Interaction at;
    at.uv = {0.4f, 0.45f};
    at.dpdu = {1.2f, 0, 0};
    at.dpdv = {0.2f, 0.8f, 0};
    return at;
}

Vector3 local_direction(float cos_theta, float phi) {
    const float sin_theta = safe_sqrt((1 - cos_theta) * (1 + cos_theta));
    return {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
}

std::vector<Vector3> viewers() {
    return {local_direction(1, 0),         local_direction(0.9f, 0.4f),
            local_direction(0.5f, 2.3f),   local_direction(0.05f, 5.1f),
            local_direction(-0.03f, 4.0f), local_direction(-0.6f, 1.1f),
            local_direction(-0.95f, 3.0f)};
}

std::optional<BSDFSample> draw(const BSDF& bsdf, const Interaction& at, Vector3 wo,
                               TransportMode mode, Rng& rng) {
    const float u_lobe = rng.next_float();
    const Vector2 u = rng.next_float2();
    return bsdf.sample(at, wo, u_lobe, u, mode);
}

RunningStatistics scattered_power(const BSDF& bsdf, Vector3 wo, TransportMode mode, int samples,
                                  int channel, std::uint64_t seed) {
    Rng rng(seed);
    RunningStatistics mean;
    for (int i = 0; i < samples; ++i) {
        const auto s = draw(bsdf, bsdf_surface(), wo, mode, rng);
        const float scale = s && mode == TransportMode::radiance ? sqr(s->eta) : 1.0f;
        mean.add(s ? scale * s->weight[channel] : 0.0f);
    }
    return mean;
}

bool is_reciprocal(const BSDF& bsdf, const Effort& effort) {
    return bsdf_reciprocity(bsdf, effort).finding(0).keeping == Keeping::kept;
}

std::array<Evidence, 2> bsdf_density(const BSDF& bsdf, const Effort& effort) {
    std::array<Evidence, 2> result = {Evidence("directions follow their density (χ²)"),
                                      Evidence("density is normalized")};
    if (!any(bsdf.lobes() & smooth_lobes)) return result;
    const std::array wos = {local_direction(0.8f, 0.4f), local_direction(0.07f, 2),
                            local_direction(-0.6f, 4)};
    const Interaction at = bsdf_surface();
    for (std::size_t i = 0; i < wos.size(); ++i) {
        const Vector3 wo = wos[i];
        const TransportMode mode = transport_modes[i % 2];
        Rng rng(hash64({effort.seed, 11}));
        const auto sample = [&](Vector2 u) -> std::optional<Vector3> {
            const auto s = bsdf.sample(at, wo, rng.next_float(), u, mode);
            if (!s || s->specular()) return {};
            return s->wi;
        };
        const auto pdf = [&](Vector3 wi) {
            return static_cast<double>(bsdf.evaluate(at, wo, wi, mode).pdf);
        };
        const SphereCounts counts(sample, pdf,
                                  {.theta_cells = 20,
                                   .phi_cells = 40,
                                   .samples = effort.samples,
                                   .seed = hash64({effort.seed, i})});
        const std::string where = "for wo = " + text(wo);
        result[0].test(counts.agreement(), where);
        result[1].test(counts.normalization(), where);
    }
    return result;
}

Evidence bsdf_weights(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("weight = f |cos θ| / pdf");
    Rng rng(hash64({effort.seed, 3}));
    const Interaction at = bsdf_surface();
    for (const Vector3 wo : viewers()) {
        for (int i = 0; i < effort.part(500); ++i) {
            const TransportMode mode = transport_modes[static_cast<std::size_t>(i % 2)];
            const auto s = draw(bsdf, at, wo, mode, rng);
            if (!s || s->specular()) continue;
            const BSDFValue value = bsdf.evaluate(at, wo, s->wi, mode);
            const auto where = [&] { return " for wo = " + text(wo) + ", wi = " + text(s->wi); };
            evidence.require(std::abs(value.pdf - s->pdf) <= 1e-4f * s->pdf, [&] {
                return fmt::format("pdf is {} from sample, {} from evaluate", s->pdf, value.pdf) +
                       where();
            });
            const Color expected = value.f * (std::abs(s->wi.z) / s->pdf);
            evidence.require(close(s->weight, expected, 1e-4f), [&] {
                return "weight is " + text(s->weight) + ", not " + text(expected) + where();
            });
        }
    }
    return evidence;
}

Evidence bsdf_samples(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("samples are what they say");
    Rng rng(hash64({effort.seed, 4}));
    for (const Vector3 wo : viewers()) {
        for (int i = 0; i < effort.part(500); ++i) {
            const auto s = draw(bsdf, bsdf_surface(), wo, transport_modes[0], rng);
            if (!s) continue;
            const auto must = [&](bool holds, const char* what) {
                evidence.require(holds, [&] {
                    return fmt::format("{} for wo = {}, wi = {}", what, text(wo), text(s->wi));
                });
            };
            must(any(s->lobe & bsdf.lobes()), "lobe is not one of lobes()");
            must((s->wi.z * wo.z < 0) == any(s->lobe & transmission_lobes),
                 "the side of wi is not that of its lobe");
            must(std::abs(glm::length(s->wi) - 1) < 1e-5f, "wi is no unit vector");
            must(s->pdf > 0, "pdf is not positive");
            must(is_sound(s->weight), "weight is negative or not finite");
            const Lobe refracting = Lobe::specular_transmission | Lobe::glossy_transmission;
            must(any(s->lobe & refracting) || s->eta == 1, "eta is not 1 without refraction");
        }
    }
    return evidence;
}

Evidence bsdf_energy(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("no energy is gained");
    // Light that is scattered back by f with its directions exchanged is as much only if f is the
    // same in both directions.
    const bool both = is_reciprocal(bsdf, effort);
    for (const TransportMode mode : transport_modes) {
        if (mode == TransportMode::importance && !both) continue;
        for (const Vector3 wo : viewers()) {
            for (int channel = 0; channel < 3; ++channel) {
                const RunningStatistics mean = scattered_power(bsdf, wo, mode, effort.part(25),
                                                               channel, hash64({effort.seed, 7}));
                const double excess = std::max(mean.mean() - 1 - 1e-3, 0.0);
                const bool exact = excess == 0 || mean.standard_error() == 0;
                const double p = excess == 0 ? 1.0
                                 : exact     ? 0.0
                                             : normal_cdf(-excess / mean.standard_error());
                evidence.test({p, fmt::format("scatters {:.4f} of the light", mean.mean())},
                              "for wo = " + text(wo));
            }
        }
    }
    for (const Vector3 wo : viewers()) {
        const Color albedo = bsdf.albedo(bsdf_surface(), wo);
        evidence.require(min_component(albedo) >= 0 && max_component(albedo) <= 1.001f,
                         [&] { return "albedo is " + text(albedo) + " for wo = " + text(wo); });
    }
    return evidence;
}

Evidence bsdf_adjoint(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("importance is the adjoint of radiance");
    Rng rng(hash64({effort.seed, 5}));
    const Interaction at = bsdf_surface();
    for (int i = 0; i < effort.part(50); ++i) {
        const auto pair = directions(bsdf, at, i % 2 == 0, rng);
        if (!pair) continue;
        const auto [a, b] = *pair;
        const Color radiance = bsdf.evaluate(at, a, b, TransportMode::radiance).f;
        const Color importance = bsdf.evaluate(at, b, a, TransportMode::importance).f;
        evidence.require(close(radiance, importance, 1e-3f), [&, a = a, b = b] {
            return fmt::format("f is {} for radiance from {} to {}, {} for importance back",
                               text(radiance), text(b), text(a), text(importance));
        });
    }
    return evidence;
}

Evidence bsdf_reciprocity(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("reflection is reciprocal");
    evidence.only_unusual();
    Rng rng(hash64({effort.seed, 6}));
    const Interaction at = bsdf_surface();
    for (int i = 0; i < effort.part(50); ++i) {
        const auto pair = directions(bsdf, at, i % 2 == 0, rng);
        if (!pair || pair->first.z * pair->second.z < 0) continue;
        const auto [a, b] = *pair;
        const Color there = bsdf.evaluate(at, a, b, TransportMode::radiance).f;
        const Color back = bsdf.evaluate(at, b, a, TransportMode::radiance).f;
        if (is_black(there) && is_black(back)) continue;
        evidence.require(close(there, back, 1e-4f), [&, a = a, b = b] {
            return fmt::format("f({}, {}) = {}, exchanged {}", text(a), text(b), text(there),
                               text(back));
        });
    }
    return evidence;
}

Evidence bsdf_support(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("density is positive where the value is");
    Rng rng(hash64({effort.seed, 8}));
    for (int i = 0; i < effort.part(20); ++i) {
        const Vector3 a = square_to_uniform_sphere(rng.next_float2());
        const Vector3 b = square_to_uniform_sphere(rng.next_float2());
        const TransportMode mode = transport_modes[static_cast<std::size_t>(i % 2)];
        const BSDFValue value = bsdf.evaluate(bsdf_surface(), a, b, mode);
        evidence.require(is_black(value.f) || value.pdf > 0, [&] {
            return fmt::format("f is {}, pdf {} for wo = {}, wi = {}", text(value.f), value.pdf,
                               text(a), text(b));
        });
    }
    return evidence;
}

Evidence bsdf_grazing(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("finite at grazing angles");
    constexpr std::array cosines = {0.0f,  1e-30f, -1e-30f, 1e-7f, -1e-7f, 1e-6f, -1e-6f,
                                    1e-3f, -1e-3f, 0.5f,    -0.5f, 1.0f,   -1.0f};
    const Interaction at = bsdf_surface();
    Rng rng(hash64({effort.seed, 9}));
    for (const float o : cosines) {
        for (const float i : cosines) {
            const Vector3 wo = local_direction(o, 2 * pi * rng.next_float());
            for (const float turn : {0.0f, pi, 1.0f}) {
                const Vector3 wi = local_direction(i, std::atan2(wo.y, wo.x) + turn);
                const BSDFValue v = bsdf.evaluate(at, wo, wi, transport_modes[0]);
                const bool sound = is_sound(v.f) && std::isfinite(v.pdf) && v.pdf >= 0;
                evidence.require(sound && (is_black(v.f) || (o != 0 && i != 0)), [&] {
                    return fmt::format("f is {}, pdf {} at cosines {}, {}", text(v.f), v.pdf, o, i);
                });
            }
        }
        for (int k = 0; k < effort.part(1000); ++k) {
            const Vector3 wo = local_direction(o, 2 * pi * rng.next_float());
            const TransportMode mode = transport_modes[static_cast<std::size_t>(k % 2)];
            const auto s = draw(bsdf, at, wo, mode, rng);
            if (!s) continue;
            const bool sound = is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf);
            evidence.require(sound && s->pdf > 0, [&] {
                return fmt::format("weight {}, pdf {} at cosine {}", text(s->weight), s->pdf, o);
            });
        }
    }
    return evidence;
}

Evidence bsdf_extreme_numbers(const BSDF& bsdf) {
    Evidence evidence("extreme random numbers are harmless");
    for (const Vector3 wo : viewers()) {
        for (int i = 0; i < 64; ++i) {
            const auto u = [&](int digit) {
                constexpr std::array values = {0.0f, 0x1p-24f, 0.5f, one_minus_epsilon};
                return values[static_cast<std::size_t>(i >> (2 * digit) & 3)];
            };
            const auto s = bsdf.sample(bsdf_surface(), wo, u(0), {u(1), u(2)}, transport_modes[0]);
            if (!s) continue;
            const bool sound = is_finite(s->wi) && is_finite(s->weight) && std::isfinite(s->pdf);
            evidence.require(sound && s->pdf > 0, [&] {
                return fmt::format("weight {}, pdf {} for u = {}, {}, {}", text(s->weight), s->pdf,
                                   u(0), u(1), u(2));
            });
        }
    }
    return evidence;
}

Evidence bsdf_transmittance(const BSDF& bsdf) {
    Evidence evidence("transmittance is what goes straight through");
    constexpr int n = 4096;
    const bool has_null = any(bsdf.lobes() & Lobe::null);
    for (const Vector3 wo : viewers()) {
        const Color told = bsdf.transmittance(bsdf_surface(), wo);
        for (const TransportMode mode : transport_modes) {
            ColorD sum(0);
            for (int i = 0; i < n; ++i) {
                const float u_lobe = (static_cast<float>(i) + 0.5f) / n;
                const auto s = bsdf.sample(bsdf_surface(), wo, u_lobe, {0.4f, 0.7f}, mode);
                if (s && s->lobe == Lobe::null) sum += ColorD(s->weight);
            }
            const Color mean(sum / static_cast<double>(n));
            const bool agrees = max_component(absolute(mean - told)) < 3e-4f;
            if (!has_null && agrees && told == Color(0)) continue;
            evidence.require(agrees && (has_null || told == Color(0)), [&] {
                return "transmittance() is " + text(told) + ", samples let " + text(mean) +
                       " through for wo = " + text(wo);
            });
        }
    }
    return evidence;
}

Evidence bsdf_lanes(const BSDF& bsdf, const Effort& effort) {
    Evidence evidence("many points at once are each by itself");
    const std::vector<Vector3> wos = viewers();
    std::array<Interaction, lane_count> places;
    std::array<const Interaction*, lane_count> at;
    Rng rng(hash64({effort.seed, 12}));
    for (std::size_t i = 0; i < lane_count; ++i) {
        places[i] = bsdf_surface();
        places[i].uv = rng.next_float2();
        at[i] = &places[i];
    }
    for (std::size_t count = 1; count <= lane_count; ++count) {
        const TransportMode mode = transport_modes[count % 2];
        Vector3Lanes wo{}, wi{};
        FloatLanes u_lobe{};
        Vector2Lanes u{};
        for (std::size_t i = 0; i < lane_count; ++i) {
            wo.set(i, wos[(i + count) % wos.size()]);
            u_lobe[i] = rng.next_float();
            u.set(i, rng.next_float2());
            wi.set(i, square_to_uniform_sphere(rng.next_float2()));
        }
        BSDFSampleLanes lanes;
        bsdf.batch().sample(bsdf, {at.data(), count}, wo, u_lobe, u, mode, lanes);
        BSDFValueLanes values;
        LaneMask wanted;
        for (std::size_t i = 0; i < lane_count; ++i) wanted[i] = (i + count) % 3 != 0;
        bsdf.batch().evaluate(bsdf, {at.data(), count}, wanted, wo, wi, mode, values);
        for (std::size_t i = 0; i < count; ++i) {
            const auto one = bsdf.sample(*at[i], wo[i], u_lobe[i], u[i], mode);
            const bool same_lobe = lanes.lobe[i] == (one ? one->lobe : Lobe::none);
            const bool same =
                same_lobe && (!one || (lanes.wi[i] == one->wi && lanes.weight[i] == one->weight));
            const BSDFValue value = bsdf.evaluate(*at[i], wo[i], wi[i], mode);
            const bool same_value =
                !wanted[i] || (values.f[i] == value.f && values.pdf[i] == value.pdf);
            evidence.require(same && same_value, [&] {
                return fmt::format("lane {} of {} differs for wo = {}", i, count, text(wo[i]));
            });
        }
    }
    return evidence;
}

std::vector<Evidence> check(const BSDF& bsdf, const Effort& effort) {
    const auto [agreement, normalization] = bsdf_density(bsdf, effort);
    return {agreement,
            normalization,
            bsdf_weights(bsdf, effort),
            bsdf_support(bsdf, effort),
            bsdf_samples(bsdf, effort),
            bsdf_energy(bsdf, effort),
            bsdf_adjoint(bsdf, effort),
            bsdf_reciprocity(bsdf, effort),
            bsdf_grazing(bsdf, effort),
            bsdf_extreme_numbers(bsdf),
            bsdf_transmittance(bsdf),
            bsdf_lanes(bsdf, effort)};
}

}  // namespace lucerna::contracts
