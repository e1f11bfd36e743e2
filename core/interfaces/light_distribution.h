// SPDX-License-Identifier: Apache-2.0
/// The lights of a scene as they are drawn at one point.
#pragma once

#include "core/interfaces/light.h"

#include <cstddef>
#include <cstring>
#include <new>
#include <optional>
#include <type_traits>

namespace lucerna {

/// What LightSampler::at returns, and a path keeps at its vertex: it holds an object of the
/// sampler's own type, which is valid as long as the sampler is not prepared anew.
class LightDistribution {
public:
    static constexpr std::size_t capacity = 384;  ///< of the object [bytes]

    /// No light is ever drawn.
    LightDistribution() : functions_(&nothing) {}
    LightDistribution(const LightDistribution& other) { *this = other; }
    LightDistribution& operator=(const LightDistribution& other) {
        if (this == &other) return *this;
        functions_ = other.functions_;
        std::memcpy(memory_, other.memory_, functions_->bytes);
        return *this;
    }

    /// Draws a light for u in [0, 1). Empty: none.
    std::optional<LightChoice> sample(double u) const { return functions_->sample(*this, u); }
    /// The number that `sample` reports as LightChoice::pmf for this light; 0 if it is not drawn.
    float pmf(std::uint32_t light) const { return functions_->pmf(*this, light); }

    /// Holds a distribution from now on: anything that has the two functions above.
    template <typename T>
    void set(const T& distribution) {
        static_assert(std::is_trivially_copyable_v<T>,
                      "a distribution is copied byte by byte: tables belong to the sampler");
        static_assert(sizeof(T) <= capacity,
                      "a distribution is small: tables belong to the sampler");
        static_assert(alignof(T) <= alignment, "wide vectors belong to the sampler");
        functions_ = &functions_of<T>;
        std::memcpy(memory_, &distribution, sizeof(T));
    }
    /// What it holds, which must be a T.
    template <typename T>
    const T& get() const {
        return *std::launder(reinterpret_cast<const T*>(memory_));
    }

private:
    static constexpr std::size_t alignment = 16;

    struct Functions {
        std::optional<LightChoice> (*sample)(const LightDistribution& lights, double u);
        float (*pmf)(const LightDistribution& lights, std::uint32_t light);
        std::size_t bytes;
    };
    static constexpr Functions nothing{
        .sample = [](const LightDistribution&, double) { return std::optional<LightChoice>(); },
        .pmf = [](const LightDistribution&, std::uint32_t) { return 0.0f; },
        .bytes = 0};
    template <typename T>
    static std::optional<LightChoice> sample_from(const LightDistribution& lights, double u) {
        return lights.get<T>().sample(u);
    }
    template <typename T>
    static float pmf_of(const LightDistribution& lights, std::uint32_t light) {
        return lights.get<T>().pmf(light);
    }
    template <typename T>
    static constexpr Functions functions_of{
        .sample = sample_from<T>, .pmf = pmf_of<T>, .bytes = sizeof(T)};

    const Functions* functions_;
    alignas(alignment) std::byte memory_[capacity];
};

}  // namespace lucerna
