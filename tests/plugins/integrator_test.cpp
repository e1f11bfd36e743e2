// SPDX-License-Identifier: Apache-2.0
/// What scenes of Mitsuba may ask of any integrator.
#include "core/interfaces/integrator.h"
#include "tests/plugins/workshop.h"

#include <gtest/gtest.h>

#include <map>

namespace lucerna {
namespace {

TEST(Integrators, TellThatTheRenderDecidesOptionsOfMitsuba) {
    const std::map<std::string, std::string> bodies = {{"moment", "<integrator type='path'/>"}};
    Workshop workshop;
    for (const std::string& name : workshop.registry().names("integrator")) {
        const auto body = bodies.find(name);
        workshop.make<Integrator>(fmt::format("<integrator type='{}'>{}{}{}{}</integrator>", name,
                                              body == bodies.end() ? "" : body->second,
                                              whole("samples_per_pass", 4), whole("block_size", 32),
                                              number("timeout", 5)));
        for (const char* option : {"samples_per_pass", "block_size", "timeout"}) {
            EXPECT_NE(workshop.warnings().find(fmt::format("\"{}\" has no effect", option)),
                      std::string::npos)
                << name;
        }
        workshop.make<Integrator>(fmt::format(
            "<integrator type='{}'>{}<boolean name='hide_emitters' value='true'/></integrator>",
            name, body == bodies.end() ? "" : body->second));
    }
}

}  // namespace
}  // namespace lucerna
