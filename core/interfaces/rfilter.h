// SPDX-License-Identifier: Apache-2.0
/// Reconstruction filter: how samples around a pixel's centre make its value.
#pragma once

#include "core/plugin/plugin.h"

namespace lucerna {

/// Separable: the filter is evaluate(x) · evaluate(y), in pixels from the centre.
class RFilter : public Object {
public:
    static constexpr const char* kind = "rfilter";
    ~RFilter() override;

    /// Zero outside [-radius, radius]. [pixels]
    virtual float radius() const = 0;
    /// Not normalised; may be negative. Symmetric.
    virtual float evaluate(float x) const = 0;
};

}  // namespace lucerna
