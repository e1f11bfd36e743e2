// SPDX-License-Identifier: Apache-2.0
/// What is wrong with an object only in its scene is told at its place, as all else.
#include "core/description/xml_reader.h"
#include "core/interfaces/light_sampler.h"
#include "core/plugin/registry.h"
#include "core/scene/builder.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

/// A light sampler that cannot be used in any scene.
class Unprepared final : public LightSampler {
public:
    explicit Unprepared(const Params&) {}
    void prepare(const Scene&) override { throw Error("these lights are too many"); }
    struct Distribution {
        std::optional<LightChoice> sample(double) const { return {}; }
        float pmf(std::uint32_t) const { return 0; }
    };
    Distribution at(const Receiver&) const { return {}; }
};

std::string complaint(const std::string& text, const char* name) {
    const PluginInfo unprepared = describe<Unprepared>("for this test");
    Registry registry;
    registry.add(name, unprepared);
    Diagnostics diagnostics;
    try {
        const Description description = read_scene_text(text, "scene.xml", {}, diagnostics);
        build_scene(description, registry, diagnostics);
        return "";
    } catch (const SceneError& error) {
        return error.what();
    }
}

TEST(PreparationErrors, TellThePlaceOfTheObject) {
    EXPECT_EQ(complaint(R"(<scene version="3.0.0">
    <sensor type="perspective"/>
    <integrator type="path">
        <light_sampler type="unprepared"/>
    </integrator>
</scene>)",
                        "unprepared"),
              R"(scene.xml:4:9: error: these lights are too many
          <light_sampler type="unprepared"/>
          ^)");
}

TEST(PreparationErrors, OfADefaultTellWhoAskedForIt) {
    EXPECT_EQ(complaint(R"(<scene version="3.0.0">
    <sensor type="perspective"/>
    <integrator type="path"/>
</scene>)",
                        "cache"),
              R"(scene.xml:3:5: error: these lights are too many
      <integrator type="path"/>
      ^)");
}

TEST(PreparationErrors, ComeWithWarningsAndInMovedScenes) {
    EXPECT_EQ(complaint(R"(<scene version="3.0.0">
    <shape type="sphere"><point name="center" x="1e6" y="0" z="0"/></shape>
    <sensor type="perspective"/>
    <integrator type="path"/>
</scene>)",
                        "cache"),
              "scene.xml:1:1: warning: the scene is moved by (-1e+06, 0, 0): it is too far from "
              "the origin for its size\n"
              "  <scene version=\"3.0.0\">\n"
              "  ^\n"
              "scene.xml:4:5: error: these lights are too many\n"
              "      <integrator type=\"path\"/>\n"
              "      ^");
}

}  // namespace
}  // namespace lucerna
