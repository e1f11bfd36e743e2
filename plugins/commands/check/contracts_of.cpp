// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/check/contracts_of.h"

#include "plugins/commands/contracts/bsdf.h"
#include "plugins/commands/contracts/emitter.h"
#include "plugins/commands/contracts/light_sampler.h"
#include "plugins/commands/contracts/light_scenes.h"
#include "plugins/commands/contracts/phase.h"
#include "plugins/commands/contracts/rfilter.h"
#include "plugins/commands/contracts/sampler.h"
#include "plugins/commands/contracts/sensor.h"
#include "plugins/commands/contracts/shape.h"
#include "plugins/commands/contracts/texture.h"

namespace lucerna {

namespace {

template <typename T>
std::vector<Evidence> contracts_alone(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make();
    return contracts::check(static_cast<const T&>(*made.object), effort);
}

std::vector<Evidence> contracts_of_shape(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make_shape();
    return contracts::check(contracts::ShapeTrial(*made.scene), effort);
}

std::vector<Evidence> contracts_of_emitter(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make_emitter();
    return contracts::check(contracts::EmitterTrial(*made.scene), effort);
}

std::vector<Evidence> contracts_of_sampler(Subject& subject, const Effort& effort) {
    const MadeSubject made = subject.make(), again = subject.make();
    return contracts::check(static_cast<const Sampler&>(*made.object),
                            static_cast<const Sampler&>(*again.object), effort);
}

/// At points anywhere among lights of all kinds, and at points that a camera sees, where samplers
/// that learn have learnt.
std::vector<Evidence> contracts_of_light_sampler(Subject& subject, const Effort& effort) {
    using namespace contracts;
    const MadeSubject anywhere = subject.make_light_sampler(many_lights());
    const MadeSubject seen = subject.make_light_sampler(courtyard(""));
    const std::vector<Receiver> everywhere = scattered_points(effort.part(400));
    const std::vector<Receiver> some = scattered_points(4);
    const std::vector<Receiver> sight = seen_points(*seen.scene, effort.part(2000), effort.seed);
    const std::vector<Receiver> few = seen_points(*seen.scene, 6, effort.seed);
    const auto trial = [](const MadeSubject& made, std::span<const Receiver> points, bool blocked) {
        return LightSamplerTrial{.sampler = static_cast<const LightSampler&>(*made.object),
                                 .scene = *made.scene,
                                 .points = points,
                                 .blocked = blocked};
    };
    return {pmf_sums(trial(anywhere, some, false)),
            pmf_of_draws(trial(anywhere, everywhere, false)),
            pmf_support(trial(anywhere, everywhere, false)),
            draw_frequencies(trial(anywhere, some, false), effort),
            draws_in_batches(trial(anywhere, everywhere, false), effort),
            pmf_sums(trial(seen, sight, true)).in("in a view"),
            pmf_support(trial(seen, sight, true)).in("in a view"),
            draw_frequencies(trial(seen, few, true), effort).in("in a view"),
            light_is_unbiased(trial(seen, few, true), effort).in("in a view")};
}

}  // namespace

std::vector<Evidence> contracts_of(Subject& subject, const Effort& effort) {
    const std::string& kind = subject.kind();
    if (kind == BSDF::kind) return contracts_alone<BSDF>(subject, effort);
    if (kind == Texture::kind) return contracts_alone<Texture>(subject, effort);
    if (kind == Phase::kind) return contracts_alone<Phase>(subject, effort);
    if (kind == Sensor::kind) return contracts_alone<Sensor>(subject, effort);
    if (kind == RFilter::kind) return contracts_alone<RFilter>(subject, effort);
    if (kind == Sampler::kind) return contracts_of_sampler(subject, effort);
    if (kind == Shape::kind) return contracts_of_shape(subject, effort);
    if (kind == Emitter::kind) return contracts_of_emitter(subject, effort);
    return contracts_of_light_sampler(subject, effort);
}

}  // namespace lucerna
