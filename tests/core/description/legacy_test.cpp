// SPDX-License-Identifier: Apache-2.0
#include "core/description/legacy.h"

#include "tests/core/description/reading.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

Description read_legacy(const std::string& content) {
    return read_valid("<scene version=\"0.6.0\">" + content + "</scene>");
}

TEST(Legacy, Names) {
    EXPECT_EQ(legacy_name("toWorld"), "to_world");
    EXPECT_EQ(legacy_name("intIOR"), "int_ior");
    EXPECT_EQ(legacy_name("maxSmoothAngle"), "max_smooth_angle");
    EXPECT_EQ(legacy_name("alphaU"), "alpha_u");
    EXPECT_EQ(legacy_name("high_quality_edges"), "high_quality_edges");
    EXPECT_EQ(legacy_name("color0"), "color0");
    EXPECT_EQ(legacy_name("SHFile"), "SHFile");  // no capital follows a small letter at first
    EXPECT_EQ(legacy_name(""), "");
}

TEST(Legacy, P8_ParametersAreRenamed) {
    const Description d = read_legacy(R"(<default name="maxDepth" value="3"/>
        <integrator type="path"><integer name="maxDepth" value="$maxDepth"/></integrator>
        <bsdf type="diffuse" id="someId"><srgb name="diffuseReflectance" value="#ff0000"/></bsdf>
        <bsdf type="plastic"><ref name="diffuseReflectance" id="t"/></bsdf>
        <texture type="checkerboard" id="t"/>
        <sensor type="perspective"><transform name="toWorld">
            <lookAt origin="0 0 0" target="0 0 1" up="0 1 0"/></transform></sensor>)");
    EXPECT_TRUE(d.legacy);
    const auto child = [&](std::size_t i) -> const Element& {
        return *d.root->children[i].element;
    };
    EXPECT_EQ(value_of<std::int64_t>(child(0), "max_depth"), 3);
    EXPECT_EQ(value_of<Rgb>(child(1), "reflectance").value, ColorD(1, 0, 0));
    EXPECT_EQ(child(1).id, "someId");
    EXPECT_EQ(child(2).children[0].name, "diffuse_reflectance");
    EXPECT_TRUE(find_property(child(4), "to_world"));
}

TEST(Legacy, ColoursMeanWhatTheyMeantThen) {
    const Description d = read_legacy(R"(<emitter type="Constant">
        <spectrum name="a" value="0.796875, 0.5, 0.0"/>
        <rgb name="b" value="1 0.5 0.2" intent="illuminant"/>
        <spectrum name="c" value="0.5" intent="reflectance"/>
        <rgb name="d" value="#ff3300"/>
        <srgb name="e" value="#808080"/>
        <blackbody name="f" temperature="5000k"/>
        <blackbody name="g" temperature="5000 K"/></emitter>)");
    const Element& emitter = *d.root->children[0].element;
    EXPECT_EQ(emitter.type, "constant");
    const auto color = [&](const char* name) { return value_of<Rgb>(emitter, name).value; };
    EXPECT_EQ(color("a"), ColorD(0.796875, 0.5, 0));
    EXPECT_EQ(color("b"), ColorD(1, 0.5, 0.2));
    EXPECT_EQ(color("c"), ColorD(0.5));
    EXPECT_EQ(color("d"), ColorD(1, 0.2, 0));
    EXPECT_NEAR(color("e").x, 0.21586050, 1e-8);
    EXPECT_EQ(color("f"), color("g"));
}

TEST(Legacy, ColoursOfNewScenesAreThoseOfToday) {
    EXPECT_EQ(errors_of(R"(<scene version="3.0.0"><bsdf type="diffuse">
<spectrum name="a" value="0.1, 0.2, 0.3"/>
<rgb name="b" value="1" intent="illuminant"/></bsdf></scene>)"),
              "2:27 expected a number, not \"0.1, 0.2, 0.3\"\n"
              "3:33 <rgb> has no attribute \"intent\"; it takes name, value\n");
    EXPECT_EQ(errors_of(R"(<scene version="0.6.0"><bsdf type="diffuse">
<rgb name="b" value="1" intent="lamp"/></bsdf></scene>)"),
              "2:33 expected reflectance or illuminant, not \"lamp\"\n");
    const Description d =
        read_content("<bsdf type='Diffuse'><rgb name='a' value='#808080'/></bsdf>");
    EXPECT_EQ(d.root->children[0].element->type, "Diffuse");
    EXPECT_NEAR(value_of<Rgb>(*d.root->children[0].element, "a").value.x, 0.21586050, 1e-8);
}

TEST(Legacy, NewScenesAreNotTouched) {
    const Description d = read_content(
        "<texture type=\"t\"><float name=\"uscale\" value=\"2\"/>"
        "<float name=\"vOffset\" value=\"2\"/></texture>");
    EXPECT_TRUE(find_property(*d.root->children[0].element, "uscale"));
    EXPECT_TRUE(find_property(*d.root->children[0].element, "vOffset"));
}

TEST(Legacy, TextureCoordinatesBecomeATransform) {
    const Description d = read_legacy(R"(<texture type="bitmap"><float name="uscale" value="2"/>
        <float name="voffset" value="0.5"/><string name="filename" value="a.png"/></texture>
        <texture type="bitmap"><float name="uvscale" value="3"/></texture>
        <texture type="bitmap"/>)");
    const Element& texture = *d.root->children[0].element;
    EXPECT_EQ(texture.properties.size(), 2u);
    const Vector3d uv = value_of<Transform>(texture, "to_uv").point(Vector3d(0.25, 0.25, 0));
    EXPECT_EQ(uv, Vector3d(0.5, 0.75, 0));
    const Transform both = value_of<Transform>(*d.root->children[1].element, "to_uv");
    EXPECT_EQ(both.point(Vector3d(1, 1, 0)), Vector3d(3, 3, 0));
    EXPECT_TRUE(d.root->children[2].element->properties.empty());
}

TEST(Legacy, Versions) {
    for (const char* version : {"0.4.0", "0.6", "1.9.9", "2.0.0", "2.1", "3", "3.5.2"}) {
        const Description d = read_valid(std::string("<scene version=\"") + version + "\"/>");
        EXPECT_EQ(d.legacy, version[0] < '2') << version;
    }
    for (const char* version : {"", "4.0.0", "-1.0", "three", "3.", "3.0.0.0", "3,0", " 3.0.0"}) {
        EXPECT_NE(errors_of(std::string("<scene version=\"") + version + "\"/>"), "") << version;
    }
}

}  // namespace
}  // namespace lucerna
