// SPDX-License-Identifier: Apache-2.0
/// Parameters of Mitsuba's integrators whose task the render has here.
#pragma once

#include "core/plugin/params.h"

namespace lucerna {

inline void accept_render_options(const Params& params) {
    params.no_effect("samples_per_pass", "passes follow from the budget of the render");
    params.no_effect("block_size", "threads share the work evenly");
    params.no_effect("timeout", "`lucerna render --time` limits a render");
}

}  // namespace lucerna
