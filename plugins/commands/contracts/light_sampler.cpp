// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/light_sampler.h"

#include <fmt/format.h>

namespace lucerna::contracts {

namespace {

std::string text(const Receiver& at) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g})", at.p.x, at.p.y, at.p.z);
}

/// The cosine with which the receiver gets light from `wi`; zero on a side that gets none.
float received(const Receiver& at, Vector3 wi) {
    const float cosine = glm::dot(wi, at.n);
    return at.sides == Sides::both ? std::abs(cosine)
                                   : std::max(at.sides == Sides::back ? -cosine : cosine, 0.0f);
}

/// What one sample of a light contributes: its share of the irradiance.
double contribution(const LightSamplerTrial& trial, const Light& light, const Receiver& at,
                    Vector2 u) {
    const auto s = light.emitter->sample_li(light, at, u);
    if (!s || !(s->pdf > 0)) return 0;
    const float cosine = received(at, s->wi);
    if (!(cosine > 0) || is_black(s->radiance)) return 0;
    if (trial.blocked && trial.scene.occluded(at, *s)) return 0;
    return static_cast<double>(luminance(s->radiance) * cosine / s->pdf);
}

}  // namespace

bool contributes(const Scene& scene, const Light& light, const Receiver& at, bool blocked) {
    for (int i = 0; i < 16; ++i) {
        const Vector2 u(static_cast<float>(i % 4) / 4 + 0.1f, static_cast<float>(i / 4) / 4 + 0.1f);
        const auto sample = light.emitter->sample_li(light, at, u);
        if (!sample || is_black(sample->radiance) || !(sample->pdf > 0)) continue;
        const float least = at.sides == Sides::both ? 0.0f : 1e-5f;
        if (!(received(at, sample->wi) > least)) continue;
        if (!blocked || !scene.occluded(at, *sample)) return true;
    }
    return false;
}

Evidence pmf_sums(const LightSamplerTrial& trial) {
    Evidence evidence("probabilities add up to the draws");
    const std::uint32_t draws = trial.sampler.draws();
    for (const Receiver& at : trial.points) {
        double sum = 0;
        for (std::uint32_t light = 0; light < trial.scene.lights().size(); ++light) {
            const float p = trial.sampler.pmf(at, light);
            evidence.require(std::isfinite(p) && p >= 0, [&] {
                return fmt::format("pmf of light {} is {} at {}", light, p, text(at));
            });
            sum += static_cast<double>(p);
        }
        evidence.require(sum <= draws * (1 + 1e-5), [&] {
            return fmt::format("they add up to {} for {} draws at {}", sum, draws, text(at));
        });
        // Less only as far as draws choose no light.
        constexpr int trials = 4000;
        const std::uint32_t tried = std::min(draws, 8u);
        double empty = 0;
        for (int i = 0; i < trials; ++i) {
            for (std::uint32_t draw = 0; draw < tried; ++draw) {
                const float u = (static_cast<float>(i) + 0.5f) / trials;
                empty += !trial.sampler.sample(at, draw, u);
            }
        }
        const double chosen = 1 - empty / (trials * tried);
        evidence.require(std::abs(sum / draws - chosen) < 2e-3, [&] {
            return fmt::format("they add up to {}, and {} of {} draws choose a light at {}", sum,
                               chosen * draws, draws, text(at));
        });
    }
    return evidence;
}

Evidence pmf_of_draws(const LightSamplerTrial& trial) {
    Evidence evidence("drawn and evaluated probability are the same");
    for (const Receiver& at : trial.points) {
        for (const float u : {0.0f, 0x1p-24f, 0.1f, 0.37f, 0.5f, 0.73f, 0.9f, 1 - 0x1p-24f}) {
            for (std::uint32_t draw = 0; draw < trial.sampler.draws(); ++draw) {
                const auto choice = trial.sampler.sample(at, draw, u);
                if (!choice) continue;
                if (!evidence.require(choice->light < trial.scene.lights().size(), [&] {
                        return fmt::format("there is no light {}", choice->light);
                    })) {
                    continue;
                }
                const float pmf = trial.sampler.pmf(at, choice->light);
                evidence.require(choice->pmf > 0 && choice->pmf == pmf, [&] {
                    return fmt::format("light {} is drawn with {}, pmf is {} at {}", choice->light,
                                       choice->pmf, pmf, text(at));
                });
            }
        }
    }
    return evidence;
}

Evidence draw_frequencies(const LightSamplerTrial& trial, const Effort& effort) {
    Evidence evidence("lights are drawn as often as pmf says (χ²)");
    const std::size_t lights = trial.scene.lights().size();
    const std::uint32_t draws = trial.sampler.draws();
    Rng rng(hash64({effort.seed, 2}));
    const int trials = effort.part(3 * static_cast<int>(draws), 5000);
    for (const Receiver& at : trial.points) {
        std::vector<double> observed(lights + 1), expected(lights + 1);
        for (int i = 0; i < trials; ++i) {
            for (std::uint32_t draw = 0; draw < draws; ++draw) {
                const auto choice = trial.sampler.sample(at, draw, rng.next_float());
                ++observed[choice ? std::min<std::size_t>(choice->light, lights) : lights];
            }
        }
        double rest = draws;
        for (std::uint32_t i = 0; i < lights; ++i) {
            expected[i] = trials * static_cast<double>(trial.sampler.pmf(at, i));
            rest -= static_cast<double>(trial.sampler.pmf(at, i));
        }
        // The sum of the probabilities is known up to rounding only.
        expected[lights] = trials * std::max(rest, 2e-6 * draws);
        // If each light is drawn once, nothing is left to chance.
        const bool certain = draws > 1 && observed[lights] == 0 &&
                             std::equal(observed.begin(), observed.end() - 1, expected.begin());
        evidence.test(certain ? Judgement{1, "each is drawn once"} : chi_square(observed, expected),
                      "at " + text(at));
    }
    return evidence;
}

Evidence pmf_support(const LightSamplerTrial& trial) {
    Evidence evidence("pmf is positive where a light contributes");
    for (const Receiver& at : trial.points) {
        for (std::uint32_t i = 0; i < trial.scene.lights().size(); ++i) {
            const bool drawn = trial.sampler.pmf(at, i) > 0;
            const Light& light = trial.scene.lights()[i];
            if (!contributes(trial.scene, light, at, trial.blocked)) continue;
            evidence.require(drawn, [&] {
                return fmt::format("light {} reaches {}, and is never drawn there", i, text(at));
            });
        }
    }
    return evidence;
}

Evidence draws_in_batches(const LightSamplerTrial& trial, const Effort& effort) {
    Evidence evidence("draws at many points are each by itself");
    Rng rng(hash64({effort.seed, 5}));
    std::vector<LightQuery> queries;
    for (const Receiver& at : trial.points) queries.push_back({.at = &at, .u = rng.next_float()});
    const std::uint32_t last = trial.sampler.draws() - 1;
    trial.sampler.batch().sample(trial.sampler, last, queries);
    for (const LightQuery& query : queries) {
        const auto one = trial.sampler.sample(*query.at, last, query.u);
        const bool same =
            query.choice.has_value() == one.has_value() &&
            (!one || (query.choice->light == one->light && query.choice->pmf == one->pmf));
        evidence.require(same, [&] { return "another choice at " + text(*query.at); });
    }
    return evidence;
}

Evidence light_is_unbiased(const LightSamplerTrial& trial, const Effort& effort) {
    Evidence evidence("arriving light is that of all lights");
    const auto lights = static_cast<std::uint32_t>(trial.scene.lights().size());
    Rng rng(hash64({effort.seed, 6}));
    const int repeats =
        effort.part(static_cast<int>(trial.points.size() * trial.sampler.draws()), 1000);
    for (const Receiver& at : trial.points) {
        // Lights that are drawn a few times only are left to χ²: their sums are far from normal.
        std::vector<bool> frequent(lights);
        for (std::uint32_t i = 0; i < lights; ++i) {
            frequent[i] = repeats * static_cast<double>(trial.sampler.pmf(at, i)) >= 50;
        }
        RunningStatistics chosen, all;
        for (int i = 0; i < repeats; ++i) {
            double sum = 0;
            for (std::uint32_t draw = 0; draw < trial.sampler.draws(); ++draw) {
                const auto choice = trial.sampler.sample(at, draw, rng.next_float());
                const Vector2 u = rng.next_float2();
                if (!choice || choice->light >= lights || !frequent[choice->light]) continue;
                sum += contribution(trial, trial.scene.lights()[choice->light], at, u) /
                       static_cast<double>(choice->pmf);
            }
            chosen.add(sum);
            if (i % 8 != 0) continue;
            double whole = 0;
            for (std::uint32_t k = 0; k < lights; ++k) {
                const Vector2 u = rng.next_float2();
                if (frequent[k]) whole += contribution(trial, trial.scene.lights()[k], at, u);
            }
            all.add(whole);
        }
        evidence.test(means_agree(chosen, all, 1e-4 * all.mean()),
                      "W/m² chosen and of all lights at " + text(at));
    }
    return evidence;
}

}  // namespace lucerna::contracts
