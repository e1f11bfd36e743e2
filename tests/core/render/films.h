// SPDX-License-Identifier: Apache-2.0
/// Films and scenes for tests of the render engine.
#pragma once

#include "core/description/xml_reader.h"
#include "core/render/render_job.h"
#include "core/scene/builder.h"

#include <memory>
#include <stdexcept>
#include <string>

namespace lucerna {

/// A film whose pixels share no samples.
inline FilmLayout square_layout(int side, std::vector<std::string> layers = {}) {
    return {.full_size = Vector2i(side),
            .crop = {.offset = Vector2i(0), .size = Vector2i(side)},
            .layers = std::move(layers)};
}

inline PixelSample grey_sample(float value) {
    PixelSample sample;
    sample.radiance = Color(value);
    return sample;
}

/// A filter by its formula.
template <typename Function>
class FormulaFilter final : public RFilter {
public:
    FormulaFilter(float radius, Function function) : radius_(radius), function_(function) {}
    float radius() const override { return radius_; }
    float evaluate(float x) const override { return std::abs(x) < radius_ ? function_(x) : 0; }

private:
    float radius_;
    Function function_;
};

/// sinc(x) sinc(x/3): a fifth of its samples are negative.
inline auto lanczos_filter() {
    const auto sinc = [](float x) { return x == 0 ? 1 : std::sin(pi * x) / (pi * x); };
    return FormulaFilter(3, [sinc](float x) { return sinc(x) * sinc(x / 3); });
}

/// One pixel wide.
inline auto box_filter() {
    return FormulaFilter(0.5f, [](float) { return 1.0f; });
}

/// Adds the next sample of a pixel that takes samples, at `offset` in it.
inline void add_sample(FilmState& film, std::size_t pixel, const PixelSample& sample,
                       const ReconstructionFilter& filter, Vector2 offset) {
    const CropWindow sampled = film.layout().sampled();
    const int i = static_cast<int>(pixel), width = sampled.size.x;
    FilmTile tile(filter,
                  {.offset = sampled.offset + Vector2i(i % width, i / width), .size = Vector2i(1)},
                  film.layout().layers.size(), film.layout().unfiltered);
    tile.add({.offset = offset,
              .half = static_cast<int>((film.first_sample() + film.samples(pixel)) & 1),
              .value = sample});
    film.add(tile, 0, film.layout().full_size.y);
}

/// To a pixel alone.
inline void add_sample(FilmState& film, std::size_t pixel, const PixelSample& sample) {
    static const ReconstructionFilter box(box_filter());
    add_sample(film, pixel, sample, box, Vector2(0.5f));
}

/// An empty scene whose film is made of the attributes and elements given.
class EmptyScene {
public:
    explicit EmptyScene(const std::string& film, const std::string& sampler = "independent")
        : description_(read_scene_text("<scene version=\"3.0.0\"><integrator type=\"depth\"/>"
                                       "<sensor type=\"perspective\"><film type=\"hdrfilm\">" +
                                           film + "</film><sampler type=\"" + sampler +
                                           "\"/></sensor></scene>",
                                       "scene.xml", {}, diagnostics_)),
          scene_(build_scene(description_, registry_, diagnostics_)) {}

    const Scene& operator*() const { return *scene_; }
    FilmState film() const { return FilmState(film_layout(*scene_)); }

    /// Renders from an empty film.
    FilmState render(const RenderJob::Estimator& estimator, RenderOptions options) const {
        return render(estimator, std::move(options), film());
    }
    FilmState render(const RenderJob::Estimator& estimator, RenderOptions options,
                     FilmState from) const {
        RenderJob job(*scene_, std::move(options), std::move(from));
        job.render_samples(estimator);
        return job.take_state();
    }

private:
    Diagnostics diagnostics_;
    Registry registry_;
    Description description_;
    std::unique_ptr<Scene> scene_;
};

inline std::string film_of_size(int width, int height) {
    return "<integer name=\"width\" value=\"" + std::to_string(width) +
           "\"/><integer name=\"height\" value=\"" + std::to_string(height) + "\"/>";
}

/// Something that depends on the ray and on many random numbers, with values of all sizes.
inline void noisy_estimate(const Ray& ray, SampleStream& stream, PixelSample& result) {
    for (int c = 0; c < 3; ++c) {
        const float u = stream.next_1d();
        result.radiance[c] = std::abs(ray.d[c]) / (u * u + 1e-6f);
    }
    result.alpha = stream.next_1d();
}

/// All bits of a state.
inline bool same_bits(const FilmState& a, const FilmState& b) {
    const auto equal = [](const ExactSum& x, const ExactSum& y) {
        return x.high == y.high && x.low == y.low;
    };
    return a.layout() == b.layout() &&
           std::equal(a.sums().begin(), a.sums().end(), b.sums().begin(), b.sums().end(), equal) &&
           std::equal(a.squares().begin(), a.squares().end(), b.squares().begin(),
                      b.squares().end(), equal) &&
           std::equal(a.weights().begin(), a.weights().end(), b.weights().begin(),
                      b.weights().end()) &&
           std::equal(a.counts().begin(), a.counts().end(), b.counts().begin(), b.counts().end()) &&
           std::equal(a.dropped().begin(), a.dropped().end(), b.dropped().begin(),
                      b.dropped().end());
}

}  // namespace lucerna
