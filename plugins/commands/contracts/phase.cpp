// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/phase.h"

#include "core/math/warp.h"

#include <fmt/format.h>

namespace lucerna::contracts {

namespace {

struct View {
    Vector3 p, wo;
};

const std::array views = {View{{0.1f, 0.2f, 0.3f}, glm::normalize(Vector3(1, 2, -3))},
                          View{{0.7f, 0.6f, 0.2f}, {0, 0, 1}}, View{{-2, 0.5f, 5}, {0, -1, 0}}};

std::string text(Vector3 w) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", w.x, w.y, w.z); }
std::string text(const View& view, Vector3 wi) {
    return "for wo = " + text(view.wo) + ", wi = " + text(wi) + " at " + text(view.p);
}

PhaseSample draw(const Phase& phase, const View& view, Rng& rng) {
    const float u_lobe = rng.next_float();
    return phase.sample(view.p, view.wo, u_lobe, rng.next_float2());
}

bool close(float a, float b, float tolerance) {
    return std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b)) + 1e-5f;
}

bool is_sound(float x) { return std::isfinite(x) && x >= 0; }

}  // namespace

std::array<Evidence, 2> phase_density(const Phase& phase, const Effort& effort) {
    std::array<Evidence, 2> result = {Evidence("directions follow their density (χ²)"),
                                      Evidence("density is normalized")};
    for (std::size_t i = 0; i < views.size(); ++i) {
        const auto [p, wo] = views[i];
        Rng rng(hash64({effort.seed, 1}));
        const auto sample = [&, p = p, wo = wo](Vector2 u) -> std::optional<Vector3> {
            return phase.sample(p, wo, rng.next_float(), u).wi;
        };
        const auto pdf = [&, p = p, wo = wo](Vector3 wi) {
            return static_cast<double>(phase.evaluate(p, wo, wi).pdf);
        };
        const SphereCounts counts(sample, pdf,
                                  {.samples = effort.samples, .seed = hash64({effort.seed, i})});
        const std::string where = "for wo = " + text(wo);
        result[0].test(counts.agreement(), where);
        result[1].test(counts.normalization(), where);
    }
    return result;
}

Evidence phase_samples(const Phase& phase, const Effort& effort) {
    Evidence evidence("samples are what evaluate says");
    Rng rng(hash64({effort.seed, 2}));
    for (const View& view : views) {
        for (int i = 0; i < effort.part(500); ++i) {
            const PhaseSample s = draw(phase, view, rng);
            const PhaseValue value = phase.evaluate(view.p, view.wo, s.wi);
            evidence.require(std::abs(glm::length(s.wi) - 1) < 1e-5f,
                             [&] { return "wi is no unit vector " + text(view, s.wi); });
            evidence.require(s.pdf > 0 && close(s.pdf, value.pdf, 2e-3f), [&] {
                return fmt::format("pdf is {} from sample, {} from evaluate ", s.pdf, value.pdf) +
                       text(view, s.wi);
            });
            evidence.require(close(s.weight * s.pdf, value.f, 2e-3f), [&] {
                return fmt::format("weight × pdf is {}, f {} ", s.weight * s.pdf, value.f) +
                       text(view, s.wi);
            });
        }
    }
    return evidence;
}

Evidence phase_integral(const Phase& phase, const Effort& effort) {
    Evidence evidence("no light is lost or gained");
    for (const View& view : views) {
        Rng rng(hash64({effort.seed, 3}));
        RunningStatistics weights;
        for (int i = 0; i < effort.samples; ++i) {
            weights.add(static_cast<double>(draw(phase, view, rng).weight));
        }
        evidence.test(mean_is(weights, 1, 1e-5), "is the integral of f for wo = " + text(view.wo));
    }
    return evidence;
}

Evidence phase_reciprocity(const Phase& phase, const Effort& effort) {
    Evidence evidence("scattering is reciprocal");
    Rng rng(hash64({effort.seed, 4}));
    for (const View& view : views) {
        for (int i = 0; i < effort.part(500); ++i) {
            const Vector3 uniform = square_to_uniform_sphere(rng.next_float2());
            const Vector3 wi = i % 2 ? uniform : draw(phase, view, rng).wi;
            const auto scattered = [&](Vector3 to, Vector3 from) {
                return phase.projected_area(view.p, to) * phase.evaluate(view.p, to, from).f;
            };
            const float there = scattered(view.wo, wi), back = scattered(wi, view.wo);
            evidence.require(std::abs(there - back) <= 1e-5f * std::max(there, back), [&] {
                return fmt::format("σ(wo) f(wo, wi) is {}, exchanged {} ", there, back) +
                       text(view, wi);
            });
        }
    }
    return evidence;
}

Evidence phase_support(const Phase& phase, const Effort& effort) {
    Evidence evidence("density is positive where the value is");
    Rng rng(hash64({effort.seed, 5}));
    for (const View& view : views) {
        std::vector<Vector3> directions = {view.wo, -view.wo};
        for (int i = 0; i < effort.part(20); ++i) {
            directions.push_back(square_to_uniform_sphere(rng.next_float2()));
        }
        for (const Vector3 wi : directions) {
            const PhaseValue value = phase.evaluate(view.p, view.wo, wi);
            const bool sound = is_sound(value.f) && is_sound(value.pdf);
            evidence.require(sound && (value.f == 0 || value.pdf > 0), [&] {
                return fmt::format("f is {}, pdf {} ", value.f, value.pdf) + text(view, wi);
            });
        }
    }
    return evidence;
}

Evidence phase_areas(const Phase& phase, const Effort& effort) {
    Evidence evidence("projected areas keep to their bound, both ways");
    Rng rng(hash64({effort.seed, 6}));
    for (const View& view : views) {
        const Bounds3 box{.min = view.p - 0.1f, .max = view.p + 0.1f};
        const float bound = phase.max_projected_area(box);
        for (int i = 0; i < effort.part(20); ++i) {
            const Vector3 w = square_to_uniform_sphere(rng.next_float2());
            const Vector3 offset(rng.next_float(), rng.next_float(), rng.next_float());
            const Vector3 p = glm::clamp(box.min + 0.2f * offset, box.min, box.max);
            const float area = phase.projected_area(p, w);
            const auto must = [&](bool holds, const char* what) {
                evidence.require(holds, [&] {
                    return fmt::format("σ is {}, {}, for w = {} at {}", area, what, text(w),
                                       text(p));
                });
            };
            must(is_sound(area), "no area");
            must(area <= bound, "above max_projected_area()");
            must(area == phase.projected_area(p, -w), "another one the other way");
            must(phase.oriented() || area == 1, "not 1 though particles are not oriented");
            must(!phase.uniform() || area == phase.projected_area(views[0].p, w),
                 "not the same everywhere");
        }
    }
    return evidence;
}

Evidence phase_extreme_numbers(const Phase& phase) {
    Evidence evidence("extreme random numbers are harmless");
    for (const View& view : views) {
        for (int i = 0; i < 64; ++i) {
            const auto u = [&](int digit) {
                constexpr std::array values = {0.0f, 0x1p-24f, 0.5f, one_minus_epsilon};
                return values[static_cast<std::size_t>(i >> (2 * digit) & 3)];
            };
            const PhaseSample s = phase.sample(view.p, view.wo, u(0), {u(1), u(2)});
            const bool sound = is_finite(s.wi) && is_sound(s.weight) && is_sound(s.pdf);
            evidence.require(sound && std::abs(glm::length(s.wi) - 1) < 1e-5f, [&] {
                return fmt::format("weight {}, pdf {} for u = {}, {}, {} ", s.weight, s.pdf, u(0),
                                   u(1), u(2)) +
                       text(view, s.wi);
            });
        }
    }
    return evidence;
}

std::vector<Evidence> check(const Phase& phase, const Effort& effort) {
    const auto [agreement, normalization] = phase_density(phase, effort);
    return {agreement,
            normalization,
            phase_samples(phase, effort),
            phase_integral(phase, effort),
            phase_reciprocity(phase, effort),
            phase_support(phase, effort),
            phase_areas(phase, effort),
            phase_extreme_numbers(phase)};
}

}  // namespace lucerna::contracts
