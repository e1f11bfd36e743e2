// SPDX-License-Identifier: Apache-2.0
/// Any bytes are either a measured material that can be drawn from, or end in an error message.
#include "core/base/error.h"
#include "plugins/bsdfs/measured_material.h"

#include <cmath>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace lucerna;
    try {
        const MeasuredMaterial material({data, size}, "fuzz");
        const Vector3 wi = glm::normalize(Vector3(0.3f, -0.4f, 0.8f));
        for (const float u : {0.0f, 0.37f, one_minus_epsilon}) {
            const Vector3 wo = material.sample(wi, {u, 1 - u});
            if (!is_finite(wo)) std::abort();
            if (!(wo.z > 0)) continue;
            const MeasuredMaterial::Value value = material.evaluate(wi, glm::normalize(wo));
            if (!std::isfinite(value.pdf) || value.pdf < 0) std::abort();
        }
    } catch (const Error& error) {
        if (error.what()[0] == '\0') std::abort();
    }
    return 0;
}
