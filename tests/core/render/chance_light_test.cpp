// SPDX-License-Identifier: Apache-2.0
#include "core/render/chance_light.h"

#include "core/description/xml_reader.h"
#include "core/scene/builder.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// Of a lamp over a sphere.
double chance(const std::string& integrator, const std::string& bsdf) {
    const std::string text = R"(<scene version="3.0.0"><integrator type=")" + integrator + R"("/>
        <sensor type="perspective"><sampler type="independent"/>
            <film type="hdrfilm"><integer name="width" value="8"/>
            <integer name="height" value="8"/></film></sensor>
        <shape type="rectangle"><transform name="to_world"><scale value="0.1"/>
            <lookat origin="0, 5, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
            <emitter type="area"><rgb name="radiance" value="300, 300, 300"/></emitter></shape>
        <emitter type="constant"><rgb name="radiance" value="1, 1, 1"/></emitter>
        <shape type="sphere"><bsdf type=")" +
                             bsdf + R"("/></shape></scene>)";
    Diagnostics diagnostics;
    Registry registry;
    const Description description = read_scene_text(text, "scene.xml", {}, diagnostics);
    return chance_luminance(*build_scene(description, registry, diagnostics));
}

TEST(ChanceLight, J8_glass_and_mirrors_send_light_that_no_light_sampling_finds) {
    EXPECT_NEAR(chance("path", "dielectric"), 300, 1);
    EXPECT_NEAR(chance("path", "conductor"), 300, 1);
    EXPECT_EQ(chance("path", "diffuse"), 0);
    EXPECT_EQ(chance("photonmap", "dielectric"), 0);
    EXPECT_EQ(chance("direct", "dielectric"), 0);
}

}  // namespace
}  // namespace lucerna
