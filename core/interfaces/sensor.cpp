// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/sensor.h"

#include "core/interfaces/medium.h"

namespace lucerna {

Sensor::Sensor(const Params& params)
    : world_from_camera_(params.transform("to_world", "from camera space to the world")),
      film_(&params.nested_or<Film>("hdrfilm", "the image to be made")),
      sampler_(&params.nested_or<Sampler>("sobol", "where random numbers come from")),
      medium_(params.nested<Medium>("in which the camera lies")) {
    params.no_effect("shutter_open", "nothing moves while the shutter is open");
    params.no_effect("shutter_close", "nothing moves while the shutter is open");
    params.no_effect("jitter", "samples are always spread over the pixel");
    params.no_effect("cone_scale", "lookups of pictures are not filtered");
    params.no_effect("srf", "rendering is done in RGB");
}

Sensor::~Sensor() = default;

std::optional<SensorConnection> Sensor::connect(Vector3, Vector2) const { return {}; }

float Sensor::distance_from_lens(const Ray&) const { return 0; }

}  // namespace lucerna
