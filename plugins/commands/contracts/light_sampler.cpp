// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/contracts/light_sampler.h"

#include <fmt/format.h>

#include <numeric>

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
    Evidence evidence("probabilities add up to one, or to the draws that choose a light");
    for (const Receiver& at : trial.points) {
        const LightDistribution lights = trial.sampler.at(at);
        double sum = 0;
        for (std::uint32_t light = 0; light < trial.scene.lights().size(); ++light) {
            const float p = lights.pmf(light);
            evidence.require(std::isfinite(p) && p >= 0, [&] {
                return fmt::format("pmf of light {} is {} at {}", light, p, text(at));
            });
            sum += static_cast<double>(p);
        }
        evidence.require(sum <= 1 + 1e-5,
                         [&] { return fmt::format("they add up to {} at {}", sum, text(at)); });
        constexpr int trials = 8000;
        double chosen = 0;
        bool exact = true;
        for (int i = 0; i < trials; ++i) {
            const auto choice = lights.sample((i + 0.5) / trials);
            if (!choice) continue;
            chosen += 1.0 / trials;
            exact &= choice->is_exact();
        }
        evidence.require(!exact || std::abs(sum - chosen) < 2e-3, [&] {
            return fmt::format("they add up to {}, and {} of the draws choose a light at {}", sum,
                               chosen, text(at));
        });
    }
    return evidence;
}

Evidence pmf_of_draws(const LightSamplerTrial& trial) {
    Evidence evidence("drawn and evaluated probability are the same");
    for (const Receiver& at : trial.points) {
        const LightDistribution lights = trial.sampler.at(at);
        for (const double u : {0.0, 0x1p-53, 0.1, 0.37, 0.5, 0.73, 0.9, 1 - 0x1p-53}) {
            const auto choice = lights.sample(u);
            if (!choice) continue;
            if (!evidence.require(choice->light < trial.scene.lights().size(), [&] {
                    return fmt::format("there is no light {}", choice->light);
                })) {
                continue;
            }
            const float pmf = lights.pmf(choice->light);
            evidence.require(choice->pmf > 0 && choice->pmf == pmf, [&] {
                return fmt::format("light {} is drawn with {}, pmf is {} at {}", choice->light,
                                   choice->pmf, pmf, text(at));
            });
            evidence.require(std::isfinite(choice->weight) && choice->weight > 0, [&] {
                return fmt::format("light {} is drawn with weight {} at {}", choice->light,
                                   choice->weight, text(at));
            });
        }
    }
    return evidence;
}

namespace {

/// What each light contributes to a point, over what all do, about.
std::vector<double> shares_of_contributions(const LightSamplerTrial& trial, const Receiver& at,
                                            Rng& rng) {
    constexpr int samples = 16;
    std::vector<double> shares;
    for (const Light& light : trial.scene.lights()) {
        double sum = 0;
        for (int i = 0; i < samples; ++i) sum += contribution(trial, light, at, rng.next_float2());
        shares.push_back(sum);
    }
    const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share /= std::max(all, 1e-300);
    return shares;
}

}  // namespace

Evidence draw_frequencies(const LightSamplerTrial& trial, const Effort& effort) {
    Evidence evidence("lights are drawn as often as their weights say");
    const std::size_t count = trial.scene.lights().size();
    Rng rng(hash64({effort.seed, 2}));
    const int trials = effort.part(3, 5000);
    for (const Receiver& at : trial.points) {
        const LightDistribution lights = trial.sampler.at(at);
        std::vector<double> observed(count + 1), expected(count + 1);
        std::vector<RunningStatistics> weights(count);
        bool exact = true;
        for (int i = 0; i < trials; ++i) {
            const auto choice = lights.sample(rng.next_double());
            const std::size_t light = choice ? std::min<std::size_t>(choice->light, count) : count;
            ++observed[light];
            exact &= light == count || choice->is_exact();
            for (std::size_t k = 0; k < count; ++k) {
                weights[k].add(k == light ? static_cast<double>(choice->weight) : 0);
            }
        }
        if (exact) {
            double rest = 1;
            for (std::uint32_t i = 0; i < count; ++i) {
                expected[i] = trials * static_cast<double>(lights.pmf(i));
                rest -= static_cast<double>(lights.pmf(i));
            }
            // The sum of the probabilities is known up to rounding only.
            expected[count] = trials * std::max(rest, 2e-6);
            evidence.test(chi_square(observed, expected), "at " + text(at) + " (χ²)");
            continue;
        }
        const std::vector<double> shares = shares_of_contributions(trial, at, rng);
        for (std::uint32_t i = 0; i < count; ++i) {
            // Less likely ones may be drawn too seldom for a normal distribution.
            const double likely = std::min(static_cast<double>(lights.pmf(i)), shares[i]);
            if (trials * likely < 100) continue;
            evidence.test(mean_is(weights[i], 1),
                          fmt::format("weights of light {} at {}", i, text(at)));
        }
    }
    return evidence;
}

Evidence pmf_support(const LightSamplerTrial& trial) {
    Evidence evidence("pmf is positive where a light contributes");
    for (const Receiver& at : trial.points) {
        const LightDistribution lights = trial.sampler.at(at);
        for (std::uint32_t i = 0; i < trial.scene.lights().size(); ++i) {
            const bool drawn = lights.pmf(i) > 0;
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
    std::vector<LightDistribution> distributions(trial.points.size());
    std::vector<const Receiver*> points;
    std::vector<LightDistribution*> out;
    std::vector<LightDraw> draws;
    for (std::size_t i = 0; i < trial.points.size(); ++i) {
        points.push_back(&trial.points[i]);
        out.push_back(&distributions[i]);
        draws.push_back({.lights = &distributions[i], .u = rng.next_double()});
    }
    trial.sampler.batch().at(trial.sampler, points, out);
    trial.sampler.batch().sample(trial.sampler, draws);
    for (std::size_t i = 0; i < draws.size(); ++i) {
        const auto one = trial.sampler.at(trial.points[i]).sample(draws[i].u);
        const auto& choice = draws[i].choice;
        const bool same = choice.has_value() == one.has_value() &&
                          (!one || (choice->light == one->light && choice->pmf == one->pmf &&
                                    choice->weight == one->weight));
        evidence.require(same, [&] { return "another choice at " + text(trial.points[i]); });
    }
    return evidence;
}

Evidence light_is_unbiased(const LightSamplerTrial& trial, const Effort& effort) {
    Evidence evidence("arriving light is that of all lights");
    const auto count = static_cast<std::uint32_t>(trial.scene.lights().size());
    Rng rng(hash64({effort.seed, 6}));
    const int repeats = effort.part(static_cast<int>(trial.points.size()), 1000);
    for (const Receiver& at : trial.points) {
        // Lights that are drawn a few times only are left to χ²: their sums are far from normal.
        const LightDistribution lights = trial.sampler.at(at);
        std::vector<bool> frequent(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            frequent[i] = repeats * static_cast<double>(lights.pmf(i)) >= 50;
        }
        RunningStatistics chosen, all;
        for (int i = 0; i < repeats; ++i) {
            const auto choice = lights.sample(rng.next_double());
            const Vector2 u_light = rng.next_float2();
            const bool counts = choice && choice->light < count && frequent[choice->light];
            chosen.add(counts
                           ? contribution(trial, trial.scene.lights()[choice->light], at, u_light) *
                                 static_cast<double>(choice->weight)
                           : 0.0);
            if (i % 8 != 0) continue;
            double whole = 0;
            for (std::uint32_t k = 0; k < count; ++k) {
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
