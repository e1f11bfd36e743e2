// SPDX-License-Identifier: Apache-2.0
/// Numbers in [0, 1) for one sample of one pixel.
///
/// A sampler is a pure function of (sequence, index, dimension): no state, so that an image does
/// not depend on threads, tiles, or how often it was resumed.
#pragma once

#include "core/interfaces/batch/sampler_batch.h"
#include "core/plugin/plugin.h"

#include <cstdint>

namespace lucerna {

class Sampler : public Object {
public:
    static constexpr const char* kind = "sampler";
    /// Reads what all samplers have: `sample_count`.
    explicit Sampler(const Params& params);
    ~Sampler() override;

    /// Number `dimension` of sample `index` of the sequence; different sequences (pixels, seeds,
    /// halves of the film) are independent. A half takes the even or the odd indices only, so these
    /// are to be well distributed by themselves.
    virtual float sample_1d(std::uint64_t sequence, std::uint64_t index,
                            std::uint32_t dimension) const = 0;
    /// Dimensions `dimension` and `dimension` + 1, well distributed together.
    virtual Vector2 sample_2d(std::uint64_t sequence, std::uint64_t index,
                              std::uint32_t dimension) const = 0;

    /// Samples per pixel if the command line does not say.
    int sample_count() const { return sample_count_; }

    /// The functions above for many at once: made by `describe`.
    using Batch = SamplerBatch;
    const Batch& batch() const { return *batch_; }

protected:
    int sample_count_ = 0;

private:
    friend Batch;
    const Batch* batch_ = nullptr;
};

/// The numbers of one sample, drawn one dimension after the other.
class SampleStream {
public:
    SampleStream(const Sampler& sampler, std::uint64_t sequence, std::uint64_t index)
        : sampler_(sampler), sequence_(sequence), index_(index) {}

    float next_1d() { return sampler_.sample_1d(sequence_, index_, dimension_++); }
    Vector2 next_2d() {
        std::uint32_t place = dimension_ - block_begin_;
        if (place >= block_size_ || place % 2 != 0) {
            block_size_ =
                2 * sampler_.batch().sample_pairs(sampler_, sequence_, index_, dimension_, block_);
            block_begin_ = dimension_;
            place = 0;
        }
        dimension_ += 2;
        return block_[place / 2];
    }
    /// Continues at a fixed dimension, so that what one bounce consumes does not shift the next.
    void jump_to(std::uint32_t dimension) { dimension_ = dimension; }

private:
    const Sampler& sampler_;
    std::uint64_t sequence_;
    std::uint64_t index_;
    std::uint32_t dimension_ = 0;
    // Pairs that were computed ahead: first dimension, number of dimensions.
    std::uint32_t block_begin_ = 0, block_size_ = 0;
    SamplerBatch::Pairs block_;
};

}  // namespace lucerna
