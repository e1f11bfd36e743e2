// SPDX-License-Identifier: Apache-2.0
#include "core/description/xml_reader.h"

#include "core/image/spectrum.h"
#include "tests/core/description/reading.h"
#include "tests/paths.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

namespace lucerna {
namespace {

constexpr const char* head = "<scene version=\"3.0.0\">";

std::string scene(const std::string& content) { return head + content + "</scene>"; }

std::string property_scene(const std::string& property) {
    return scene("<shape type=\"sphere\">" + property + "</shape>");
}

const Element& first_object(const Description& description) {
    return *description.root->children.at(0).element;
}

Matrix4d transform_of(const std::string& steps) {
    const Description d =
        read_content("<shape type=\"s\"><transform name=\"t\">" + steps + "</transform></shape>");
    return value_of<Transform>(first_object(d), "t").matrix();
}

void expect_near(const Matrix4d& a, const Matrix4d& b) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], 1e-12) << c << " " << r;
    }
}

TEST(XmlReader, Objects) {
    const Description d = read_valid(R"(<?xml version="1.0" encoding="utf-8"?>
        <!-- a comment -->
        <scene version="3.0.0">
            <shape type="sphere" id="ball">
                <bsdf type="diffuse" name="skin"><texture type="bitmap" name="reflectance"/></bsdf>
                <emitter type="area"/>
            </shape>
        </scene>)");
    EXPECT_EQ(d.root->kind, "scene");
    EXPECT_FALSE(d.legacy);
    EXPECT_NE(d.hash, 0u);
    EXPECT_EQ(d.elements.size(), 5u);
    EXPECT_EQ(d.search_paths, std::vector<std::string>{"."});
    const Element& shape = first_object(d);
    EXPECT_EQ(shape.kind, "shape");
    EXPECT_EQ(shape.type, "sphere");
    EXPECT_EQ(shape.id, "ball");
    ASSERT_EQ(shape.children.size(), 2u);
    EXPECT_EQ(shape.children[0].name, "skin");
    EXPECT_EQ(shape.children[0].element->children[0].element->kind, "texture");
    EXPECT_EQ(shape.children[1].name, "");
    EXPECT_EQ(shape.where.file->text.substr(shape.where.offset, 6), "<shape");
}

TEST(XmlReader, Properties) {
    const Description d = read_content(R"(<shape type="sphere">
        <boolean name="b" value="true"/> <integer name="i" value="-7"/>
        <float name="f" value="0.25"/> <string name="s" value=" a &amp; b &#x3b1; "/>
        <point name="p" x="1" z="3"/> <vector name="v" value="1, 2, 3"/>
        <rgb name="c" value="0.1 0.2 0.3"/> <srgb name="e" value="#ffffff"/>
        <spectrum name="u" value="5"/> <transform name="t"/>
    </shape>)");
    const Element& e = first_object(d);
    EXPECT_EQ(value_of<bool>(e, "b"), true);
    EXPECT_EQ(value_of<std::int64_t>(e, "i"), -7);
    EXPECT_EQ(value_of<double>(e, "f"), 0.25);
    EXPECT_EQ(value_of<std::string>(e, "s"), " a & b \xce\xb1 ");
    EXPECT_EQ(value_of<Triple>(e, "p").value, Vector3d(1, 0, 3));
    EXPECT_EQ(value_of<Triple>(e, "v").value, Vector3d(1, 2, 3));
    EXPECT_EQ(value_of<Rgb>(e, "c").value, ColorD(0.1, 0.2, 0.3));
    EXPECT_EQ(value_of<Rgb>(e, "e").value, ColorD(1));
    EXPECT_EQ(value_of<Rgb>(e, "u").value, ColorD(5));
    EXPECT_TRUE(value_of<Transform>(e, "t").is_identity());
    std::string types;
    for (const Property& p : e.properties) types += std::string(type_name(p.value)) + " ";
    EXPECT_EQ(types, "boolean integer float string point point rgb rgb rgb transform ");
}

TEST(XmlReader, SpectraBecomeColours) {
    const TemporaryFolder folder;
    std::ofstream(folder / "white.spd") << "# nm, value\n300 1\n900 1\n";
    std::ofstream(folder / "scene.xml")
        << scene(R"(<bsdf type="d"><spectrum name="r" value="300:1, 900:1"/>
                        <spectrum name="file" filename="white.spd"/></bsdf>
                    <emitter type="e"><spectrum name="r" value="300:1, 900:1"/>
                        <texture type="t"><spectrum name="r" value="300:1, 900:1"/>
                            <spectrum name="c" value="30"/></texture>
                        <blackbody name="k" temperature="6500K" scale="2"/></emitter>)");
    Diagnostics diagnostics;
    const Description d = read_scene(folder / "scene.xml", {}, diagnostics);
    ASSERT_EQ(diagnostics.error_count(), 0) << diagnostics.all()[0].text();
    const auto color = [](const Element& e, const char* name) {
        return value_of<Rgb>(e, name).value;
    };
    const Element& bsdf = *d.root->children[0].element;
    const Element& emitter = *d.root->children[1].element;
    // A white reflectance is 1; a white emission is not D65, so it is reddish.
    EXPECT_NEAR(color(bsdf, "r").x, 1, 1e-3);
    EXPECT_NEAR(color(bsdf, "r").z, 1, 1e-3);
    EXPECT_EQ(color(bsdf, "file"), color(bsdf, "r"));
    EXPECT_GT(color(emitter, "r").x, 1.1);
    // As in Mitsuba 3.9.1: a texture in an emitter is the same as elsewhere.
    EXPECT_EQ(color(*emitter.children[0].element, "r"), color(bsdf, "r"));
    EXPECT_EQ(color(*emitter.children[0].element, "c"), ColorD(30));
    EXPECT_EQ(color(emitter, "k"), ColorD(blackbody(6500)) * 2.0);
}

/// What Mitsuba 3.9.1 (scalar_rgb) makes of the same plugins; those that it refuses there become
/// what the other ways of writing them do.
TEST(XmlReader, SpectrumPluginsAreColours) {
    const std::string spectra = R"(
        <spectrum name="uniform" type="uniform"><float name="value" value="0.3"/></spectrum>
        <spectrum name="srgb" type="srgb"><rgb name="color" value="0.2 0.4 0.8"/></spectrum>
        <spectrum name="white" type="d65"/>
        <spectrum name="dim" type="d65"><float name="scale" value="0.5"/></spectrum>
        <spectrum name="d65" type="d65"><rgb name="color" value="0.2 0.4 0.8"/>
            <integer name="scale" value="5"/></spectrum>
        <spectrum name="raw" type="rawconstant"><vector name="value" value="3 2 -1"/></spectrum>
        <spectrum name="grey" type="rawconstant"><float name="value" value="0.3"/></spectrum>
        <spectrum name="even" type="regular"><float name="wavelength_min" value="400"/>
            <float name="wavelength_max" value="700"/>
            <string name="values" value="0.1 0.5 0.9"/></spectrum>
        <spectrum name="uneven" type="irregular"><string name="wavelengths" value="400,550,700"/>
            <string name="values" value="0.1, 0.5, 0.9"/></spectrum>
        <spectrum name="list" value="400:0.1, 550:0.5, 700:0.9"/>
        <texture name="texture" type="uniform"><float name="value" value="0.3"/></texture>
        <spectrum name="hot" type="blackbody"><float name="temperature" value="5000"/>
            <float name="scale" value="2"/></spectrum>)";
    const Description d = read_content("<bsdf type='d'>" + spectra + "</bsdf><emitter type='e'>" +
                                       spectra + "</emitter>");
    for (const Child& child : d.root->children) {
        const Element& e = *child.element;
        const auto color = [&](const char* name) { return value_of<Rgb>(e, name).value; };
        EXPECT_EQ(color("uniform"), ColorD(0.3));
        EXPECT_EQ(color("texture"), ColorD(0.3));
        EXPECT_EQ(color("srgb"), ColorD(0.2, 0.4, 0.8));
        EXPECT_EQ(color("white"), ColorD(1));
        EXPECT_EQ(color("dim"), ColorD(0.5));
        EXPECT_LT(glm::distance(color("d65"), ColorD(1, 2, 4)), 1e-12);
        EXPECT_EQ(color("raw"), ColorD(3, 2, -1));
        EXPECT_EQ(color("grey"), ColorD(0.3));
        EXPECT_EQ(color("even"), color("list"));
        EXPECT_EQ(color("uneven"), color("list"));
        EXPECT_EQ(color("hot"), 2.0 * ColorD(blackbody(5000)));
    }
    EXPECT_NE(value_of<Rgb>(*d.root->children[0].element, "even").value,
              value_of<Rgb>(*d.root->children[1].element, "even").value);
}

TEST(XmlReader, P8_ANameAfterADollarMayGoOnAsText) {
    Diagnostics diagnostics;
    const Description d = read_scene_text(
        "<scene version='3.0.0'><default name='part' value='ball'/>"
        "<default name='part2' value='cube'/>"
        "<shape type='obj'><string name='a' value='$part1.obj'/>"
        "<string name='b' value='$part2.obj'/><string name='c' value='${part}1.obj'/></shape>"
        "</scene>",
        "scene.xml", {}, diagnostics);
    const Element& shape = *d.root->children[0].element;
    EXPECT_EQ(value_of<std::string>(shape, "a"), "ball1.obj");
    EXPECT_EQ(value_of<std::string>(shape, "b"), "cube.obj");
    EXPECT_EQ(value_of<std::string>(shape, "c"), "ball1.obj");
    ASSERT_EQ(diagnostics.all().size(), 1u);
    EXPECT_EQ(diagnostics.all()[0].message, "\"$part1\" has no value; it is taken as ${part}1");
    EXPECT_EQ(diagnostics.error_count(), 0);
    EXPECT_NE(errors_of("<scene version='3.0.0'><default name='part' value='ball'/>"
                        "<shape type='${part1}'/></scene>"),
              "");
}

/// Expected for eta and k: what Mitsuba 3.9.1 (scalar_rgb) makes of them.
TEST(XmlReader, P8_SpectraOfPhysicalQuantitiesAreNotCutAtOne) {
    const std::string eta = "value='400:1.2,500:1.0,600:0.4,700:0.2'";
    const std::string k = "value='400:2,500:2,600:3,700:4'";
    const Description d =
        read_content("<bsdf type='conductor'><spectrum name='eta' " + eta +
                     "/><spectrum name='k' " + k + "/><spectrum name='specular_reflectance' " + k +
                     "/></bsdf><medium type='m'><spectrum name='sigma_t' " + k + "/></medium>");
    const Element& bsdf = *d.root->children[0].element;
    const auto near = [](ColorD a, ColorD b) {
        return glm::distance(a, b) < 2e-3 * glm::length(b);
    };
    EXPECT_TRUE(near(value_of<Rgb>(bsdf, "eta").value, {0.217593, 0.75108, 1.13994}));
    const ColorD extinction = value_of<Rgb>(bsdf, "k").value;
    EXPECT_TRUE(near(extinction, {3.43622, 2.39058, 1.91836}));
    EXPECT_EQ(value_of<Rgb>(bsdf, "specular_reflectance").value, ColorD(1));
    const Element& medium = *d.root->children[1].element;
    EXPECT_EQ(value_of<Rgb>(medium, "sigma_t").value, extinction);
}

TEST(XmlReader, P8_SpectraOfVolumesAreWhatTheVolumesAreFor) {
    const std::string value = "<spectrum name='value' value='400:2,500:2,600:3,700:4'/>";
    const Description d =
        read_content("<medium type='m'><volume name='albedo' type='v'>" + value +
                     "</volume><volume name='sigma_t' type='v'>" + value + "</volume></medium>");
    const Element& medium = *d.root->children[0].element;
    EXPECT_EQ(value_of<Rgb>(*medium.children[0].element, "value").value, ColorD(1));
    EXPECT_GT(value_of<Rgb>(*medium.children[1].element, "value").value.x, 2);
}

TEST(XmlReader, OneValueOfASpectrumIsEqualEnergyAsLightSinceVersion2) {
    const auto read = [](const std::string& version) {
        const TemporaryFolder folder;
        std::ofstream(folder / "scene.xml")
            << "<scene version='" + version +
                   "'><bsdf type='d'><spectrum name='r' value='0.5'/></bsdf>"
                   "<emitter type='e'><spectrum name='r' value='5000'/></emitter></scene>";
        Diagnostics diagnostics;
        const Description d = read_scene(folder / "scene.xml", {}, diagnostics);
        const auto color = [&](std::size_t i) {
            return value_of<Rgb>(*d.root->children.at(i).element, "r").value;
        };
        return std::pair(color(0), color(1));
    };
    EXPECT_EQ(read("0.6.0"), std::pair(ColorD(0.5), ColorD(5000)));
    const auto [reflectance, light] = read("3.0.0");
    EXPECT_EQ(reflectance, ColorD(0.5));
    // XYZ = (1, 1, 1) by the matrix of Rec.709; the tables of the CIE give X = Y = Z to 10⁻⁴.
    EXPECT_NEAR(light.x / 5000, 1.204976, 5e-4);
    EXPECT_NEAR(light.y / 5000, 0.948279, 5e-4);
    EXPECT_NEAR(light.z / 5000, 0.908625, 5e-4);
}

TEST(XmlReader, TransformsAreAppliedInOrder) {
    expect_near(transform_of("<translate x=\"1\"/><scale value=\"2\"/>"),
                Matrix4d(2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 2, 0, 0, 1));
    expect_near(transform_of("<scale y=\"3\"/><translate value=\"1 2 3\"/>"),
                Matrix4d(1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1));
    expect_near(transform_of("<rotate z=\"1\" angle=\"90\"/>"),
                Matrix4d(0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1));
    expect_near(transform_of("<rotate value=\"0,0,2\" angle=\"90\"/>"),
                transform_of("<rotate z=\"1\" angle=\"90\"/>"));
    expect_near(transform_of("<matrix value=\"1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\"/>"),
                transform_of("<translate x=\"5\" y=\"6\" z=\"7\"/>"));
    expect_near(transform_of("<matrix value=\"0 -1 0 1 0 0 0 0 1\"/>"),
                transform_of("<rotate z=\"1\" angle=\"90\"/>"));
    expect_near(transform_of("<lookat origin=\"1 2 3\" target=\"1 2 4\" up=\"0 1 0\"/>"),
                transform_of("<translate x=\"1\" y=\"2\" z=\"3\"/>"));
    expect_near(transform_of("<translate value=\"3\"/>"),
                transform_of("<translate x=\"3\" y=\"3\" z=\"3\"/>"));
    // Every step is invertible, but their product overflows.
    std::string steps;
    for (int i = 0; i < 20; ++i) steps += "<scale value=\"1e30\"/>";
    EXPECT_NE(errors_of(property_scene("<transform name=\"t\">" + steps + "</transform>")), "");
}

TEST(XmlReader, P8_WithoutUpTheImageIsTurnedAsByMitsuba) {
    // Results of Mitsuba 3.9.1.
    const auto look = [](const std::string& target) {
        return transform_of("<lookat origin=\"0 0 4\" target=\"" + target + "\"/>");
    };
    const auto expect_axes = [](const Matrix4d& m, Vector3d x, Vector3d y) {
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(m[0][i], x[i], 1e-6);
            EXPECT_NEAR(m[1][i], y[i], 1e-6);
        }
    };
    expect_axes(look("0 0 0"), {0, 1, 0}, {1, 0, 0});
    expect_axes(look("0 0 9"), {0, -1, 0}, {1, 0, 0});
    expect_axes(look("1 2 3"), {-0.23670068, 0.52659863, 0.8164966},
                {0.8816497, -0.23670068, 0.4082483});
    expect_axes(look("-1 5 2"), {0.12208685, 0.38956574, 0.91287094},
                {0.97558266, 0.12208685, -0.18257418});
}

TEST(XmlReader, ReferencesAndAliases) {
    const Description d = read_content(R"(<shape type="s"><ref id="later"/></shape>
        <bsdf type="twosided" id="later"><ref name="inner" id="also"/></bsdf>
        <alias id="white" as="again"/> <alias id="again" as="also"/>
        <bsdf type="diffuse" id="white"/>)");
    const Element& twosided = *first_object(d).children.at(0).element;
    EXPECT_EQ(twosided.id, "later");
    EXPECT_EQ(twosided.children.at(0).name, "inner");
    EXPECT_EQ(twosided.children[0].element->id, "white");
    EXPECT_EQ(d.root->children.size(), 3u);
}

TEST(XmlReader, DefaultsAndDefinitions) {
    const std::string text = scene(R"(<default name="w" value="64"/> <default name="w" value="1"/>
        <default name="file" value="mesh_${w}.obj"/>
        <shape type="obj"><integer name="w" value="$w"/>
            <string name="f" value="a/$file"/></shape>)");
    Description d = read_valid(text);
    EXPECT_EQ(value_of<std::int64_t>(first_object(d), "w"), 64);
    EXPECT_EQ(value_of<std::string>(first_object(d), "f"), "a/mesh_64.obj");
    d = read_valid(text, {.defines = {{"w", "7"}, {"w", "8"}}});
    EXPECT_EQ(value_of<std::int64_t>(first_object(d), "w"), 8);
    EXPECT_EQ(value_of<std::string>(first_object(d), "f"), "a/mesh_8.obj");
    // Without a default in the scene, and with a $ that stays what it is.
    d = read_content("<shape type=\"$t\"/>", {.defines = {{"t", "$x"}}});
    EXPECT_EQ(first_object(d).type, "$x");
}

TEST(XmlReader, UnusedDefinitionsAreErrors) {
    EXPECT_EQ(errors_of(scene("<default name=\"spp\" value=\"1\"/><shape type=\"$spp\"/>"),
                        {.defines = {{"ssp", "4"}}}),
              "1:1 the scene has no parameter \"ssp\"; it has spp; did you mean \"spp\"?\n");
    EXPECT_EQ(errors_of(scene(""), {.defines = {{"a", "4"}}}),
              "1:1 the scene has no parameter \"a\"; it has none\n");
}

TEST(XmlReader, ExpansionIsBounded) {
    std::string text = "<default name=\"a0\" value=\"0123456789\"/>";
    for (int i = 1; i <= 30; ++i) {
        text += fmt::format("<default name=\"a{}\" value=\"${{a{}}}${{a{}}}\"/>", i, i - 1, i - 1);
    }
    ReadOptions options;
    options.limits.max_bytes = 1 << 20;
    EXPECT_NE(errors_of(scene(text), options).find("expand to is too long"), std::string::npos);
}

TEST(XmlReader, K1_K2_entities_and_doctype_are_refused) {
    EXPECT_EQ(errors_of("<!DOCTYPE scene [<!ENTITY a \"b\">]><scene version=\"3.0.0\"/>"),
              "1:1 DOCTYPE is not accepted\n");
    EXPECT_EQ(errors_of("<!DOCTYPE scene SYSTEM \"file:///etc/passwd\"><scene version=\"3.0.0\"/>"),
              "1:1 DOCTYPE is not accepted\n");
    EXPECT_EQ(errors_of(property_scene("<string name=\"a\" value=\"x&lol;\"/>")),
              "1:70 unknown entity \"&lol;\"\n");
    for (const char* value : {"&#0;", "&#x1;", "&#xd800;", "&#x110000;", "&#;", "&#x;", "&;", "&",
                              "&amp", "a & b", "&amp;lt;&x;", "&#99999999999;"}) {
        const std::string text = fmt::format("<string name=\"a\" value=\"{}\"/>", value);
        EXPECT_NE(errors_of(property_scene(text)), "") << value;
    }
    const Description d = read_content(
        "<shape type=\"s\"><string name=\"a\" "
        "value=\"&lt;&gt;&amp;&quot;&apos;&#65;&amp;lt;\"/></shape>");
    EXPECT_EQ(value_of<std::string>(first_object(d), "a"), "<>&\"'A&lt;");
}

std::string nested(int depth, const std::string& begin, const std::string& end) {
    std::string text = head;
    for (int i = 0; i < depth; ++i) text += begin;
    for (int i = 0; i < depth; ++i) text += end;
    return text + "</scene>";
}

TEST(XmlReader, K3_depth_is_bounded) {
    const std::string begin = "<bsdf type=\"t\">", end = "</bsdf>";
    EXPECT_EQ(errors_of(nested(63, begin, end)), "");
    for (const int depth : {64, 1000, 200'000}) {
        EXPECT_NE(errors_of(nested(depth, begin, end)).find("nested deeper than 64"),
                  std::string::npos);
    }
    EXPECT_NE(errors_of(nested(200'000, begin, "")), "");
    // The same depth by references, each of which is flat.
    std::string chain = head;
    for (int i = 0; i < 100'000; ++i) {
        chain += fmt::format("<bsdf type=\"t\" id=\"b{}\"><ref id=\"b{}\"/></bsdf>", i, i + 1);
    }
    chain += "<bsdf type=\"t\" id=\"b100000\"/></scene>";
    EXPECT_NE(errors_of(chain).find("refer to each other deeper than 64"), std::string::npos);
}

TEST(XmlReader, K4_errors_have_the_place_of_the_value) {
    EXPECT_EQ(errors_of("<scene version=\"3.0.0\">\n  <shape type=\"s\">\n    <float name='radius'"
                        "\n           value = '1.5m'/>\n  </shape>\n</scene>"),
              "4:21 expected a number, not \"1.5m\"\n");
}

TEST(XmlReader, K9_text_that_is_almost_xml_is_refused) {
    for (const std::string& text : {std::string(""),
                                    std::string("  \n"),
                                    std::string("<"),
                                    std::string("scene"),
                                    std::string("<!-- -->"),
                                    std::string("<scene"),
                                    std::string("<scene version=\"3.0.0\""),
                                    std::string("<scene version=\"3.0.0\">"),
                                    std::string("<scene version='3.0.0\"/>"),
                                    std::string("<scene version=3.0.0/>"),
                                    std::string("<scene version=\"3.0.0\"/>x"),
                                    std::string("x<scene version=\"3.0.0\"/>"),
                                    scene("x"),
                                    scene("<![CDATA[x]]>"),
                                    scene("") + scene(""),
                                    scene("<shape type=\"a\" type=\"a\"/>"),
                                    scene("<shape type=\"a\" id=\"b\" type=\"c\"/>"),
                                    scene("<shape type=\"<\"/>"),
                                    scene("<!-- \xff -->"),
                                    scene("<shape type=\"\xc0\x80\"/>"),
                                    scene("\xed\xa0\x80"),
                                    scene("<shape type=\"a\xe2\x82\"/>"),
                                    scene("\x01"),
                                    scene("</shape>"),
                                    scene("<shape type=\"a\"></bsdf>"),
                                    scene("<?x"),
                                    scene("<!-- x"),
                                    scene("<![CDATA["),
                                    scene("<!x>"),
                                    scene("<>"),
                                    scene("< shape/>")}) {
        EXPECT_NE(errors_of(text), "") << text;
    }
}

TEST(XmlReader, K10_ids_are_unique) {
    EXPECT_EQ(errors_of("<scene version=\"3.0.0\">\n<bsdf type=\"a\" id=\"x\"/>\n"
                        "<bsdf type=\"b\" id=\"x\"/></scene>"),
              "3:20 the id \"x\" is used already, at scene.xml:2:20\n");
}

TEST(XmlReader, K11_references_lead_somewhere_and_not_in_a_circle) {
    EXPECT_EQ(errors_of(scene("<shape type=\"s\"><ref id=\"x\"/></shape>")),
              "1:40 no element has the id \"x\"; no element has an id\n");
    EXPECT_EQ(errors_of(scene("<bsdf type=\"a\" id=\"x\"><ref id=\"x\"/></bsdf>")),
              "1:46 this reference leads in a circle: \"x\" -> \"x\"\n");
    EXPECT_NE(errors_of(scene("<alias id=\"a\" as=\"b\"/><alias id=\"b\" as=\"a\"/>"
                              "<shape type=\"s\"><ref id=\"a\"/></shape>")),
              "");
    // Many ways to one element are no circle, and are not walked one by one.
    std::string ladder = "<bsdf type=\"t\" id=\"b0\"/>";
    for (int i = 1; i < 60; ++i) {
        ladder += fmt::format(
            "<bsdf type=\"t\" id=\"b{0}\"><ref id=\"b{1}\"/><ref id=\"b{1}\"/></bsdf>", i, i - 1);
    }
    EXPECT_EQ(errors_of(scene(ladder)), "");
}

class Includes : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }
    /// Errors of scene.xml, one a line, with relative paths.
    std::string read(const ReadOptions& options = {}) {
        Diagnostics diagnostics;
        description_ = read_scene(folder_ / "scene.xml", options, diagnostics);
        std::string text;
        for (const Diagnostic& d : diagnostics.all()) {
            text += fmt::format("{}:{}:{} {}\n", d.file, d.line, d.column, d.message);
        }
        const std::string prefix = folder_.path().string() + "/";
        for (std::size_t at = 0; (at = text.find(prefix, at)) != std::string::npos;) {
            text.erase(at, prefix.size());
        }
        return text;
    }

    TemporaryFolder folder_;
    Description description_;
};

TEST_F(Includes, AreReadInPlace) {
    write("scene.xml", scene("<include filename=\"parts/a.xml\"/><shape type=\"$kind\"/>"));
    write("parts/a.xml",
          "<scene><default name=\"kind\" value=\"cube\"/>"
          "<include filename=\"b.xml\"/></scene>");
    write("parts/b.xml", "<bsdf type=\"diffuse\" id=\"white\"/>");
    EXPECT_EQ(read(), "");
    ASSERT_EQ(description_.root->children.size(), 2u);
    EXPECT_EQ(description_.root->children[0].element->id, "white");
    EXPECT_EQ(description_.root->children[1].element->type, "cube");
    EXPECT_EQ(description_.sources.size(), 3u);
    EXPECT_EQ(description_.search_paths.size(), 2u);
}

TEST_F(Includes, K12_are_finite) {
    write("scene.xml", scene("<include filename=\"a.xml\"/>"));
    write("a.xml", scene("<include filename=\"./scene.xml\"/>"));
    EXPECT_EQ(read(), "a.xml:1:43 this file includes itself: scene.xml -> a.xml -> scene.xml\n");
    for (int i = 0; i < 20; ++i) {
        write(fmt::format("{}.xml", i),
              scene(fmt::format("<include filename=\"{}.xml\"/>", i + 1)));
    }
    write("scene.xml", scene("<include filename=\"0.xml\"/>"));
    EXPECT_EQ(read(), "14.xml:1:43 files include each other deeper than 15\n");
    // Not deep, but of 2^15 elements.
    for (int i = 0; i < 15; ++i) {
        const std::string next = fmt::format("<include filename=\"{}.xml\"/>", i + 1);
        write(fmt::format("{}.xml", i), scene(next + next));
    }
    write("scene.xml", scene("<include filename=\"1.xml\"/>"));
    write("15.xml", scene("<bsdf type=\"diffuse\"/>"));
    ReadOptions options;
    options.limits.max_elements = 10'000;
    EXPECT_NE(read(options).find("more than 10000 elements"), std::string::npos);
    options.limits.max_elements = 1'000'000;
    options.limits.max_bytes = 10'000;
    EXPECT_NE(read(options).find("more than 10000 bytes"), std::string::npos);
}

TEST_F(Includes, K13_are_looked_for_beside_the_file_and_on_its_paths) {
    write("scene.xml", scene("<path value=\"lib\"/><include filename=\"a.xml\"/>"));
    write("lib/a.xml", scene("<include filename=\"b.xml\"/>"));
    write("lib/b.xml", scene("<bsdf type=\"diffuse\"/>"));
    EXPECT_EQ(read(), "");
    write("scene.xml", scene("<path value=\"lib\"/>\n<include filename=\"c.xml\"/>"));
    EXPECT_EQ(read(),
              "scene.xml:2:20 there is no file \"c.xml\"\n  looked for c.xml\n"
              "  looked for lib/c.xml\n");
    write("scene.xml", scene("<include filename=\"lib\"/>"));
    EXPECT_NE(read(), "");
    std::filesystem::remove(folder_ / "scene.xml");
    EXPECT_NE(read(), "");
}

TEST_F(Includes, HaveTheirOwnVersion) {
    write("scene.xml", scene("<include filename=\"old.xml\"/><shape type=\"s\">"
                             "<float name=\"newName\" value=\"1\"/></shape>"));
    write("old.xml",
          "<scene version=\"0.5.0\"><shape type=\"s\"><float name=\"oldName\" "
          "value=\"1\"/></shape></scene>");
    EXPECT_EQ(read(), "");
    EXPECT_TRUE(description_.legacy);
    EXPECT_TRUE(find_property(*description_.root->children[0].element, "old_name"));
    EXPECT_TRUE(find_property(*description_.root->children[1].element, "newName"));
}

TEST(XmlReader, K14_unknown_elements_and_attributes_are_refused) {
    EXPECT_EQ(errors_of(scene("<shpae type=\"s\"/>")),
              "1:24 there is no element <shpae>; did you mean \"shape\"?\n");
    EXPECT_EQ(errors_of(scene("<shape type=\"s\" nmae=\"x\"/>")),
              "1:46 <shape> has no attribute \"nmae\"; it takes type, id, name; did you mean "
              "\"name\"?\n");
    EXPECT_EQ(errors_of(property_scene("<float name=\"a\" value=\"1\" unit=\"m\"/>")),
              "1:77 <float> has no attribute \"unit\"; it takes name, value\n");
}

TEST(XmlReader, K15_size_is_bounded_and_large_scenes_are_read) {
    ReadOptions options;
    options.limits.max_elements = 100;
    std::string shapes;
    for (int i = 0; i < 1000; ++i) shapes += "<shape type=\"s\"/>";
    EXPECT_NE(errors_of(scene(shapes), options).find("more than 100 elements"), std::string::npos);
    options = {};
    options.limits.max_bytes = 1000;
    EXPECT_NE(errors_of(scene(shapes), options).find("more than 1000 bytes"), std::string::npos);
    const std::string value(10'000'000, 'x');
    EXPECT_EQ(errors_of(property_scene("<string name=\"a\" value=\"" + value + "\"/>")), "");
    EXPECT_NE(errors_of(property_scene("<float name=\"a\" value=\"" + value + "\"/>")), "");
    std::string attributes = "<shape type=\"s\"";
    for (int i = 0; i < 100'000; ++i) attributes += fmt::format(" a{}=\"\"", i);
    EXPECT_NE(errors_of(scene(attributes + "/>")).find("too many attributes"), std::string::npos);
}

TEST(XmlReader, K15_many_errors_end_the_reading) {
    std::string shapes;
    for (int i = 0; i < 100'000; ++i) shapes += "<shpe type=\"s\"/>\n";
    Diagnostics diagnostics;
    read_scene_text(scene(shapes), "scene.xml", {}, diagnostics);
    EXPECT_LT(diagnostics.all().size(), 60u);
    EXPECT_EQ(diagnostics.all().back().message, "too many errors; what follows was not read");
}

TEST(XmlReader, K16_only_utf8_is_read) {
    EXPECT_EQ(errors_of("\xef\xbb\xbf" + scene("")), "");
    EXPECT_EQ(errors_of("\xef\xbb\xbf" + scene("\n<float name=\"a\" value=\"x\"/>")),
              "2:24 expected a number, not \"x\"\n");
    EXPECT_EQ(errors_of("<?xml version=\"1.0\" encoding=\"UTF-16\"?>" + scene("")),
              "1:1 the file says that it is \"UTF-16\"; save it as UTF-8\n");
    const auto wide = [](const std::string& text, bool big_endian) {
        std::string result = big_endian ? "\xfe\xff" : "\xff\xfe";
        for (const char c : text) {
            result += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
        }
        return result;
    };
    for (const bool big_endian : {false, true}) {
        const std::string text = wide(scene(""), big_endian);
        const std::string expected = "the file is UTF-16 or UTF-32; save it as UTF-8\n";
        EXPECT_EQ(errors_of(text), "1:1 " + expected);
        EXPECT_EQ(errors_of(text.substr(2)), "1:1 " + expected);
    }
    std::string nul = scene("<shape type=\"s\"/>");
    nul[30] = '\0';
    EXPECT_EQ(errors_of(nul), "1:31 control character 0x00 in the text\n");
}

TEST(XmlReader, NamesAreUniqueInAnElement) {
    EXPECT_EQ(
        errors_of(property_scene("<float name=\"a\" value=\"1\"/><rgb name=\"a\" value=\"1\"/>")),
        "1:72 \"a\" is given twice; first at scene.xml:1:45\n");
    EXPECT_NE(
        errors_of(property_scene("<bsdf type=\"b\" name=\"a\"/><float name=\"a\" value=\"1\"/>")),
        "");
}

TEST(XmlReader, AllErrorsAreCollected) {
    EXPECT_EQ(errors_of(scene("\n<shape type=\"s\"><float name=\"a\" value=\"x\"/></shape>\n"
                              "<bsdf type=\"$t\"><ref id=\"none\"/></bsdf>\n<bsdf/>")),
              "2:40 expected a number, not \"x\"\n"
              "3:13 \"$t\" has no value; give it one above, with <default name=\"t\" "
              "value=\"...\"/>, or with -D t=...\n"
              "4:1 <bsdf> needs the attribute \"type\"\n"
              "3:17 no element has the id \"none\"; no element has an id\n");
}

TEST(XmlReader, DescriptionsCanBeMoved) {
    Description a =
        read_content("<bsdf type=\"diffuse\" id=\"x\"/><shape type=\"s\"><ref id=\"x\"/></shape>");
    const Element* const root = a.root;
    const Description b = std::move(a);
    EXPECT_EQ(&b.elements.front(), root);
    EXPECT_EQ(root->where.file, &b.sources.front());
    EXPECT_EQ(root->where.file->path, "scene.xml");
    EXPECT_EQ(hash_of(b), b.hash);
}

TEST(XmlReader, HashTellsScenesApart) {
    const auto hash = [](const std::string& content) { return read_content(content).hash; };
    const std::string base = R"(<shape type="s" id="a"><float name="r" value="1"/><string name="f"
        value="x.obj"/></shape>)";
    // Neither ids nor the order of properties, comments or white space count.
    EXPECT_EQ(hash(base), hash(R"(<!-- --><shape type="s" id="b"><string name="f" value="x.obj"/>
        <float name="r" value="1.0"/></shape>)"));
    std::vector<std::uint64_t> hashes = {hash(base), hash("")};
    for (
        const char* other :
        {R"(<shape type="t"><float name="r" value="1"/><string name="f" value="x.obj"/></shape>)",
         R"(<shape type="s"><float name="r" value="2"/><string name="f" value="x.obj"/></shape>)",
         R"(<shape type="s"><integer name="r" value="1"/><string name="f" value="x.obj"/></shape>)",
         R"(<shape type="s"><float name="q" value="1"/><string name="f" value="x.obj"/></shape>)",
         R"(<shape type="s"><float name="r" value="1"/><string name="f" value="y.obj"/></shape>)",
         R"(<shape type="s"><float name="r" value="1"/></shape>)",
         R"(<shape type="s"><string name="ab" value="c"/></shape>)",
         R"(<shape type="s"><string name="a" value="bc"/></shape>)",
         R"(<shape type="s"><transform name="t"/></shape>)",
         R"(<shape type="s"><transform name="t"><translate x="1"/></transform></shape>)",
         R"(<shape type="s"/><shape type="t"/>)", R"(<shape type="t"/><shape type="s"/>)",
         R"(<shape type="s"><shape type="t"/></shape>)",
         R"(<shape type="s"><shape name="x" type="t"/></shape>)"}) {
        hashes.push_back(hash(other));
    }
    std::sort(hashes.begin(), hashes.end());
    EXPECT_EQ(std::unique(hashes.begin(), hashes.end()), hashes.end());
}

}  // namespace
}  // namespace lucerna
