// SPDX-License-Identifier: Apache-2.0
#include "core/description/overrides.h"

#include "tests/core/description/reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

constexpr const char* text = R"(<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="5"/></integrator>
    <sensor type="perspective" id="camera">
        <film type="hdrfilm"><rfilter type="gaussian"/></film>
    </sensor>
    <bsdf type="diffuse" id="a.b"><texture type="bitmap" name="reflectance" id="wood"/></bsdf>
    <shape type="sphere" id="left"><ref id="a.b"/></shape>
    <shape type="sphere" id="right"><bsdf type="mirror" name="surface"/></shape>
</scene>)";

Description with(std::vector<std::string> overrides) {
    ReadOptions options;
    options.overrides = std::move(overrides);
    return read_valid(text, options);
}

std::string error_of(const std::string& override_text) {
    ReadOptions options;
    options.overrides = {override_text};
    return errors_of(text, options);
}

const Element& child(const Description& d, std::size_t i) { return *d.root->children[i].element; }

std::string text_of(const Element& element, const char* name) {
    return value_of<UntypedText>(element, name).text;
}

TEST(Overrides, ReplaceAndAddParameters) {
    const Description d = with({"integrator.max_depth=8", "integrator.rr_depth=3",
                                "camera.film.rfilter.stddev=0.4", "integrator.note=a=b"});
    const Element& integrator = child(d, 0);
    EXPECT_EQ(integrator.properties.size(), 3u);
    EXPECT_EQ(text_of(integrator, "max_depth"), "8");
    EXPECT_EQ(text_of(integrator, "rr_depth"), "3");
    EXPECT_EQ(text_of(integrator, "note"), "a=b");
    const Location where = find_property(integrator, "max_depth")->where;
    EXPECT_EQ(where.file->path, "--set");
    EXPECT_EQ(where.file->text.substr(where.offset), "max_depth=8");
    const Element& rfilter = *child(d, 1).children[0].element->children[0].element;
    EXPECT_EQ(text_of(rfilter, "stddev"), "0.4");
}

TEST(Overrides, FindByNameIdAndKind) {
    const Description d = with({"wood.filename=x.png", "a.b.two=2", "right.surface.three=3",
                                "left.bsdf.four=4", "sensor.film.five=5"});
    const Element& bsdf = child(d, 2);
    EXPECT_EQ(text_of(*bsdf.children[0].element, "filename"), "x.png");
    EXPECT_EQ(text_of(bsdf, "two"), "2");
    EXPECT_EQ(text_of(bsdf, "four"), "4");
    EXPECT_EQ(text_of(*child(d, 4).children[0].element, "three"), "3");
    EXPECT_EQ(text_of(*child(d, 1).children[0].element, "five"), "5");
}

TEST(Overrides, ReplaceTypes) {
    const Description d = with({"integrator=direct", "sensor.film.rfilter=box", "right.type=cube",
                                "camera.sampler=sobol", "camera.sampler.sample_count=4",
                                "integrator.light_sampler=power"});
    EXPECT_EQ(child(d, 0).type, "direct");
    EXPECT_TRUE(child(d, 0).type_overridden);
    EXPECT_EQ(child(d, 0).properties.size(), 1u);
    EXPECT_EQ(child(d, 1).children[0].element->children[0].element->type, "box");
    EXPECT_EQ(child(d, 4).type, "cube");
    ASSERT_EQ(child(d, 1).children.size(), 2u);
    const Element& sampler = *child(d, 1).children[1].element;
    EXPECT_EQ(sampler.kind, "sampler");
    EXPECT_EQ(sampler.type, "sobol");
    EXPECT_FALSE(sampler.type_overridden);
    EXPECT_EQ(text_of(sampler, "sample_count"), "4");
    EXPECT_EQ(child(d, 0).children.at(0).element->kind, "light_sampler");
    EXPECT_FALSE(child(with({"integrator=path"}), 0).type_overridden);
}

/// --resolution sets the last two, one after the other.
TEST(Overrides, ReachWhatASceneHasWithoutSayingSo) {
    ReadOptions options;
    options.overrides = {"sensor.sampler.sample_count=4", "sensor.film.width=8",
                         "sensor.film.height=6"};
    for (const char* sensor : {"", "<sensor type=\"perspective\"/>"}) {
        const Description d =
            read_valid(fmt::format("<scene version=\"3.0.0\">{}</scene>", sensor), options);
        ASSERT_EQ(d.root->children.size(), 1u);
        const Element& camera = child(d, 0);
        EXPECT_EQ(camera.type, "perspective");
        ASSERT_EQ(camera.children.size(), 2u);
        const Element &sampler = *camera.children[0].element, &film = *camera.children[1].element;
        EXPECT_EQ(text_of(sampler, "sample_count"), "4");
        EXPECT_EQ(film.type, "hdrfilm");
        EXPECT_EQ(text_of(film, "width"), "8");
        EXPECT_EQ(text_of(film, "height"), "6");
    }
}

/// A scene of several sensors is rendered with the first, so `--resolution` is about that one.
TEST(Overrides, OfSeveralSensorsTheFirstIsMeant) {
    ReadOptions options;
    options.overrides = {"sensor.film.width=8"};
    const Description d = read_valid(
        "<scene version='3.0.0'><film type='hdrfilm' id='film'/>"
        "<sensor type='perspective'><ref id='film'/></sensor>"
        "<sensor type='orthographic'><film type='hdrfilm'/></sensor></scene>",
        options);
    EXPECT_EQ(text_of(*child(d, 1).children[0].element, "width"), "8");
    EXPECT_EQ(find_property(*child(d, 2).children[0].element, "width"), nullptr);
}

TEST(Overrides, AValueTakesThePlaceOfATexture) {
    const Description d = with({"a.b.reflectance=0.5"});
    EXPECT_TRUE(child(d, 2).children.empty());
    EXPECT_EQ(text_of(child(d, 2), "reflectance"), "0.5");
}

TEST(Overrides, ErrorsSayWhatThereIs) {
    EXPECT_EQ(error_of("integrater.max_depth=1"),
              "1:1 the scene has no \"integrater\"; it has integrator, sensor, camera, bsdf, a.b, "
              "shape, left, right; did you mean \"integrator\"?\n");
    EXPECT_EQ(error_of("camera.flim.width=1"),
              "1:8 <sensor type=\"perspective\"> has no \"flim\"; it has film; did you mean "
              "\"film\"?\n");
    EXPECT_EQ(error_of("wood.a.b=1"),
              "1:6 <texture type=\"bitmap\"> has no \"a\"; nothing is nested in it\n");
    EXPECT_EQ(error_of("shape.radius=1"),
              "1:1 there are 2 <shape> here; name one by its id: left, right\n");
    for (const char* wrong :
         {"", "=", "a", "integrator", "integrator=", "integrator.type=", ".a=1", "integrator.=1",
          "integrator..a=1", "max_depth=1", "type=x", "scene.integrator=path", "shape=cube"}) {
        EXPECT_NE(error_of(wrong), "") << wrong;
    }
}

TEST(Overrides, ChangeTheHash) {
    EXPECT_NE(with({"integrator.max_depth=8"}).hash, with({}).hash);
    EXPECT_NE(with({"integrator.max_depth=8"}).hash, with({"integrator.max_depth=9"}).hash);
    EXPECT_EQ(with({"integrator=path"}).hash, with({}).hash);
}

}  // namespace
}  // namespace lucerna
