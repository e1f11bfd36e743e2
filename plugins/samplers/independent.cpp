// SPDX-License-Identifier: Apache-2.0
/// independent: numbers that know nothing of each other.
///
/// Each is a hash of seed, sequence, index and dimension. Noisier than the other samplers, but
/// free of structure: use it for statistics that need independent samples.
#include "plugins/samplers/seeded.h"

namespace lucerna {

namespace {

class IndependentSampler final : public SeededSampler {
public:
    explicit IndependentSampler(const Params& params) : SeededSampler(params) {}

    float sample_1d(std::uint64_t sequence, std::uint64_t index,
                    std::uint32_t dimension) const override {
        return uint_to_float(static_cast<std::uint32_t>(bits(sequence, index, dimension) >> 32));
    }

    Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                      std::uint32_t dimension) const override {
        const std::uint64_t x = bits(sequence, index, dimension);
        return {uint_to_float(static_cast<std::uint32_t>(x >> 32)),
                uint_to_float(static_cast<std::uint32_t>(x))};
    }

private:
    std::uint64_t bits(std::uint64_t sequence, std::uint64_t index, std::uint32_t dimension) const {
        return hash_combine(key(sequence, dimension), index);
    }
};

}  // namespace

const PluginInfo plugin = describe<IndependentSampler>("independent random numbers");

}  // namespace lucerna
