// SPDX-License-Identifier: Apache-2.0
/// Light that is met by chance only: that of small lamps by way of mirrors and glass. No light
/// sampling finds it, so that all samples of an image may have missed it.
#pragma once

namespace lucerna {

class Scene;

/// The largest luminance that paths from the camera may meet so [W/(m² sr)], emission averaged over
/// each light; 0 if nothing is specular, or if the integrator knows another way (photons).
double chance_luminance(const Scene& scene);

}  // namespace lucerna
