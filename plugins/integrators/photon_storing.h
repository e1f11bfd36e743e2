// SPDX-License-Identifier: Apache-2.0
/// Photons of a pass where they are kept, in the order of emission.
#pragma once

#include "plugins/integrators/photon.h"
#include "plugins/integrators/photon_tracing.h"

#include <functional>

namespace lucerna {

/// The result of many photons, in their order whatever the number of threads.
struct StoredPhotons {
    std::vector<Photon> photons;   ///< on surfaces
    std::vector<Photon> caustics;  ///< on surfaces, if the pass keeps them apart
    std::vector<Photon> in_media;  ///< where media scattered them
    PhotonEnergy energy;
    double emitted = 0;  ///< number of photons that left the lights

    void append(const StoredPhotons& other) {
        photons.insert(photons.end(), other.photons.begin(), other.photons.end());
        caustics.insert(caustics.end(), other.caustics.begin(), other.caustics.end());
        in_media.insert(in_media.end(), other.in_media.begin(), other.in_media.end());
        energy += other.energy;
    }
};

/// Stores photons that come to matte surfaces, or are scattered by media, as the pass says.
class PhotonStore {
public:
    PhotonStore(const PhotonPass& pass, StoredPhotons& result) : pass_(pass), result_(result) {}

    void operator()(const PhotonHit& hit) const {
        if (!hit.stored || !pass_.on_surfaces) return;
        const float side = std::copysign(1.0f, glm::dot(hit.w, hit.at.n));
        const bool apart = pass_.caustics_apart && hit.kind == PhotonKind::caustic;
        (apart ? result_.caustics : result_.photons)
            .emplace_back(hit.at.p, hit.power, hit.w, side * hit.at.n, hit.depth);
        result_.energy.stored += static_cast<double>(luminance(hit.power));
    }
    void operator()(const MediumHit& hit) const {
        if (!pass_.in_media) return;
        result_.in_media.emplace_back(hit.p, hit.power, hit.w, hit.w, hit.depth);
        result_.energy.stored += static_cast<double>(luminance(hit.power));
    }

private:
    const PhotonPass& pass_;
    StoredPhotons& result_;
};

/// Traces photons begin … end − 1 of a pass and stores them.
inline void store_photons(const PhotonTracer& tracer, const PhotonPass& pass, std::uint64_t begin,
                          std::uint64_t end, StoredPhotons& result) {
    tracer.trace(pass, begin, end, result.energy, PhotonStore(pass, result));
}

/// Traces a pass in parallel and appends its photons to `result`. Ends early if `interrupted`.
///
/// Each task fills a chunk of its own. While a batch of chunks is traced, the batch before is
/// appended, so that no thread waits for it; batches bound what is held twice, and their memory
/// serves again.
inline void store_photons(const PhotonTracer& tracer, const PhotonPass& pass,
                          const Workers& workers, const std::function<bool()>& interrupted,
                          StoredPhotons& result) {
    constexpr std::uint64_t chunk_size = 512, batch_size = 128;
    std::vector<StoredPhotons> batch(batch_size), before(batch_size);
    const auto append = [&] {
        for (StoredPhotons& chunk : before) {
            result.append(chunk);
            chunk.photons.clear();
            chunk.caustics.clear();
            chunk.in_media.clear();
            chunk.energy = {};
        }
    };
    for (std::uint64_t first = 0; first < pass.count; first += batch_size * chunk_size) {
        const std::uint64_t end = std::min(first + batch_size * chunk_size, pass.count);
        const std::uint64_t chunks = (end - first + chunk_size - 1) / chunk_size;
        workers.run(static_cast<std::int64_t>(1 + chunks), [&](std::int64_t task) {
            if (task == 0) return append();
            if (interrupted()) return;
            const auto c = static_cast<std::uint64_t>(task - 1);
            const std::uint64_t begin = first + c * chunk_size;
            store_photons(tracer, pass, begin, std::min(begin + chunk_size, end), batch[c]);
        });
        std::swap(batch, before);
    }
    append();
    result.emitted += static_cast<double>(pass.count);
}

}  // namespace lucerna
