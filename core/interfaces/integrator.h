// SPDX-License-Identifier: Apache-2.0
/// Light transport: from a scene and a sensor to an image.
#pragma once

#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sampler.h"
#include "core/plugin/plugin.h"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace lucerna {

class RenderJob;

/// One sample of a pixel.
struct PixelSample {
    Color radiance{0};        ///< [W/(m² sr)]
    float alpha = 1;          ///< 0 where the ray left the scene
    std::span<float> layers;  ///< one number per `layers()`, zero when called
    Color unfiltered{0};      ///< goes to the pixel as it is, if the integrator has such a thing
    std::size_t pixel = 0;    ///< number of the pixel: see FilmLayout::sampled()
};

/// A camera ray, the random numbers that belong to it, and what the integrator makes of it.
struct CameraSample {
    Ray ray;
    SampleStream stream;
    PixelSample result;
    std::uint32_t block = 0;  ///< samples that stand together and have the same number make a block

    /// Number `index` of a sequence of the sampler; all else is yet to be filled.
    CameraSample(const Sampler& sampler, std::uint64_t sequence, std::uint64_t index)
        : stream(sampler, sequence, index) {}
    CameraSample(const Ray& ray_, const SampleStream& stream_, const PixelSample& result_)
        : ray(ray_), stream(stream_), result(result_) {}
};

class Integrator : public Object {
public:
    static constexpr const char* kind = "integrator";
    ~Integrator() override;

    /// Fills the film of the job within its budget. Throws Error if the scene cannot be rendered.
    virtual void render(RenderJob& job) const = 0;

    /// Names of channels beside R, G, B, A, in EXR style: "albedo.R".
    virtual std::vector<std::string> layers() const { return {}; }
    /// PixelSample::unfiltered counts: it has been through the reconstruction filter already.
    virtual bool unfiltered() const { return false; }
    /// Pixels are sampled in aligned blocks of so many by so many, a power of two up to 16: the
    /// samples with the same index in all pixels of a block are estimated together.
    virtual int block_size() const { return 1; }

    /// Media scatter and absorb the light that it estimates; otherwise they are not there.
    virtual bool renders_media() const { return false; }

    /// Lights are sampled at what the camera sees, itself or in mirrors, and after up to this many
    /// bounces off other surfaces; -1: nowhere. Light samplers prepare for no more.
    virtual int light_bounces() const { return std::numeric_limits<int>::max(); }
};

}  // namespace lucerna
