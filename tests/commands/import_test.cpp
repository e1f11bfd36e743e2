// SPDX-License-Identifier: Apache-2.0
/// `lucerna import`: a model of each format makes the same picture as the scene that one would
/// write by hand.
#include "core/image/png.h"
#include "core/interfaces/command.h"
#include "tests/commands/process.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

/// A roof over a floor, in one light, seen from the side.
const char* const obj_model = R"(mtllib model.mtl
o floor
v -2 0 -2
v -2 0 2
v 2 0 2
v 2 0 -2
usemtl ground
f 1 2 3 4
o roof
v -1 0.2 -1
v -1 0.2 1
v 0 1 1
v 0 1 -1
usemtl tiles
f 5 6 7 8
l 5 7
)";
const char* const mtl =
    "newmtl ground\nKd 0.5 0.4 0.3\nKs 0 0 0\n"
    "newmtl tiles\nKd 0.7 0.1 0.1\nKs 0 0 0\n";

const char* const dae_model = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1" name="meter"/><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="eye" name="eye"><optics><technique_common><perspective>
 <xfov>50</xfov><aspect_ratio>1.5</aspect_ratio><znear>0.1</znear><zfar>100</zfar>
</perspective></technique_common></optics></camera></library_cameras>
<library_lights><light id="lamp" name="lamp"><technique_common><point><color>20 18 16</color>
 <constant_attenuation>0</constant_attenuation><linear_attenuation>0</linear_attenuation>
 <quadratic_attenuation>1</quadratic_attenuation></point></technique_common></light>
</library_lights>
<library_effects><effect id="fx"><profile_COMMON><technique sid="common"><lambert>
 <diffuse><color>0.5 0.4 0.3 1</color></diffuse></lambert></technique></profile_COMMON></effect>
</library_effects>
<library_materials><material id="ground" name="ground"><instance_effect url="#fx"/></material>
</library_materials>
<library_geometries><geometry id="plane" name="plane"><mesh>
 <source id="pos"><float_array id="pos-array" count="12">-1 0 -1 -1 0 1 1 0 1 1 0 -1</float_array>
  <technique_common><accessor source="#pos-array" count="4" stride="3">
  <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
  </accessor></technique_common></source>
 <vertices id="vert"><input semantic="POSITION" source="#pos"/></vertices>
 <polylist material="m" count="1"><input semantic="VERTEX" source="#vert" offset="0"/>
  <vcount>4</vcount><p>0 1 2 3</p></polylist></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="floor"><scale>2 1 2</scale>
 <instance_geometry url="#plane"><bind_material><technique_common>
 <instance_material symbol="m" target="#ground"/></technique_common></bind_material>
 </instance_geometry></node>
 <node id="step"><translate>0.5 0.5 0</translate><rotate>0 0 1 20</rotate>
 <instance_geometry url="#plane"><bind_material><technique_common>
 <instance_material symbol="m" target="#ground"/></technique_common></bind_material>
 </instance_geometry></node>
 <node id="lamp_node"><translate>-1 3 1</translate><instance_light url="#lamp"/></node>
 <node id="eye_node"><translate>0 1.5 6</translate><instance_camera url="#eye"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";

const char* const gltf_model = R"({"asset": {"version": "2.0"}, "scene": 0,
"extensionsUsed": ["KHR_lights_punctual"],
"extensions": {"KHR_lights_punctual": {"lights": [
  {"type": "point", "color": [1, 0.9, 0.8], "intensity": 20, "name": "lamp"}]}},
"scenes": [{"nodes": [0, 1, 2, 3]}],
"nodes": [{"mesh": 0, "scale": [2, 1, 2], "name": "floor"},
  {"mesh": 1, "translation": [0.5, 0.5, 0], "name": "step"},
  {"name": "lamp_node", "translation": [-1, 3, 1],
   "extensions": {"KHR_lights_punctual": {"light": 0}}},
  {"name": "eye_node", "translation": [0, 1.5, 6], "camera": 0}],
"cameras": [{"type": "perspective",
  "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1, "zfar": 100}}],
"materials": [{"name": "paint", "doubleSided": true, "pbrMetallicRoughness":
   {"baseColorFactor": [0.5, 0.4, 0.3, 1], "metallicFactor": 0, "roughnessFactor": 0.6}},
  {"name": "steel", "doubleSided": true, "pbrMetallicRoughness":
   {"baseColorFactor": [0.6, 0.6, 0.7, 1], "metallicFactor": 1, "roughnessFactor": 0.7}}],
"meshes": [{"name": "plane", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
   "material": 0}]},
  {"name": "plate", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1,
   "material": 1}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
   "min": [-1, 0, -1], "max": [1, 0, 1]},
  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48},
  {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
"buffers": [{"byteLength": 60, "uri": "model.bin"}]})";

std::string gltf_buffer() {
    std::string bytes;
    for (const float x : {-1.f, 0.f, -1.f, -1.f, 0.f, 1.f, 1.f, 0.f, 1.f, 1.f, 0.f, -1.f}) {
        const auto bits = std::bit_cast<std::uint32_t>(x);
        for (int i = 0; i < 4; ++i) bytes += static_cast<char>(bits >> (8 * i) & 255);
    }
    for (const int i : {0, 1, 2, 0, 2, 3}) bytes += {static_cast<char>(i), 0};
    return bytes;
}

/// A square of the half size `s` that faces up, and the BSDF of one side or of both.
std::string square(double s, const std::string& steps, const std::string& bsdf,
                   bool two_sided = true) {
    return fmt::format(
        "<shape type='rectangle'><transform name='to_world'>"
        "<rotate x='1' angle='-90'/><scale value='{}'/>{}</transform>{}</shape>",
        s, steps, two_sided ? "<bsdf type='twosided'>" + bsdf + "</bsdf>" : bsdf);
}
const char* const matte =
    "<bsdf type='diffuse'><rgb name='reflectance' value='0.5, 0.4, 0.3'/></bsdf>";

std::string principled(const char* color, double roughness, double metallic) {
    return fmt::format(
        "<bsdf type='principled'><rgb name='base_color' value='{}'/>"
        "<float name='roughness' value='{}'/><float name='metallic' value='{}'/></bsdf>",
        color, roughness, metallic);
}

std::string eye(const std::string& fov) {
    return "<sensor type='perspective'>" + fov +
           "<transform name='to_world'><lookat origin='0, 1.5, 6' target='0, 1.5, 0' "
           "up='0, 1, 0'/></transform><film type='hdrfilm'/><sampler type='sobol'/></sensor>";
}
const char* const gltf_view =
    "<float name='fov' value='34.377468'/><string name='fov_axis' value='y'/>";
const char* const lamp =
    "<emitter type='point'><point name='position' x='-1' y='3' z='1'/>"
    "<rgb name='intensity' value='20, 18, 16'/></emitter>";

class Import : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(program_path().parent_path() /
                        "../lib/lucerna/plugins/commands/import.so")) {
            GTEST_SKIP() << "built without assimp";
        }
    }
    std::string run(const std::vector<std::string>& words, int expected = exit_code::success) {
        Process process(folder.path(), words);
        EXPECT_EQ(process.wait(), expected) << process.errors() << process.output();
        errors = process.errors();
        return process.output();
    }
    void write(const char* name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
    }
    /// Both make the same picture: not only in the mean, as random numbers are the same.
    void expect_same_picture(const std::string& by_hand) {
        write("hand.xml",
              "<scene version='3.0.0'><integrator type='path'/>" + by_hand + "</scene>");
        for (const char* name : {"model", "hand"}) {
            run({"render", std::string(name) + ".xml", "--resolution", "48x32", "--spp", "16",
                 "--set", "integrator.max_depth=2", "-q"});
        }
        run({"diff", "model.exr", "hand.exr", "--max-relmse", "1e-5"});
    }
    static void expect_words(const std::string& text, const std::vector<std::string>& words) {
        for (const std::string& word : words) {
            EXPECT_NE(text.find(word), std::string::npos) << "\"" << word << "\" in:\n" << text;
        }
    }

    TemporaryFolder folder;
    std::string errors;
};

TEST_F(Import, obj_is_the_scene_with_the_same_mesh) {
    write("model.obj", obj_model);
    write("model.mtl", mtl);
    const std::string table = run({"import", "model.obj"});
    expect_words(table, {"converted     material  ground", "mesh      floor", "2 triangles",
                         "added         camera", "added         light", "model.xml"});
    // The camera that was added looks at the middle of the box from (0.6, 0.45, 1) diagonals.
    const double diagonal = std::sqrt(4 * 4 + 1 * 1 + 4 * 4);
    const std::string camera = fmt::format(
        "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
        "<lookat origin='{}, {}, {}' target='0, 0.5, 0' up='0, 1, 0'/></transform>"
        "<film type='hdrfilm'/><sampler type='sobol'/></sensor>",
        0.6 * diagonal, 0.5 + 0.45 * diagonal, diagonal);
    write("floor.obj", "v -2 0 -2\nv -2 0 2\nv 2 0 2\nv 2 0 -2\nf 1 2 3 4\n");
    write("roof.obj", "v -1 0.2 -1\nv -1 0.2 1\nv 0 1 1\nv 0 1 -1\nf 1 2 3 4\n");
    const auto part = [](const char* file, const char* color) {
        return fmt::format(
            "<shape type='obj'><string name='filename' value='{}'/>"
            "<bsdf type='twosided'><bsdf type='diffuse'>"
            "<rgb name='reflectance' value='{}'/></bsdf></bsdf></shape>",
            file, color);
    };
    expect_same_picture(camera + part("floor.obj", "0.5, 0.4, 0.3") +
                        part("roof.obj", "0.7, 0.1, 0.1") +
                        "<emitter type='constant'><float name='radiance' value='1'/></emitter>");
}

TEST_F(Import, collada_with_its_camera_light_and_transforms) {
    write("model.dae", dae_model);
    expect_words(run({"import", "model.dae"}),
                 {"converted     camera    eye_node", "converted     light     lamp_node",
                  "converted     material  ground", "converted     mesh      plane"});
    // The floor and the step are one mesh, placed twice.
    expect_words(read_whole(folder / "model.xml"),
                 {"<shape type=\"shapegroup\" id=\"plane_group\">", "<shape type=\"instance\">"});
    expect_same_picture(eye("<float name='fov' value='50'/>") + square(2, "", matte) +
                        square(1, "<rotate z='1' angle='20'/><translate x='0.5' y='0.5'/>", matte) +
                        lamp);
}

TEST_F(Import, gltf_with_its_camera_light_and_materials) {
    write("model.gltf", gltf_model);
    write("model.bin", gltf_buffer());
    expect_words(run({"import", "model.gltf"}), {"camera", "light", "converted     material  paint",
                                                 "converted     material  steel"});
    // The picture has its aspect from --resolution; glTF gives the vertical field of view.
    expect_same_picture(
        eye(gltf_view) + square(2, "", principled("0.5, 0.4, 0.3", 0.6, 0)) +
        square(1, "<translate x='0.5' y='0.5'/>", principled("0.6, 0.6, 0.7", 0.7, 1)) + lamp);
}

TEST_F(Import, gltf_pictures_of_roughness_metal_and_normals) {
    std::string text = gltf_model;
    const auto replace = [&](const std::string& from, const std::string& to) {
        ASSERT_NE(text.find(from), std::string::npos);
        text.replace(text.find(from), from.size(), to);
    };
    replace(R"(["KHR_lights_punctual"])",
            R"(["KHR_lights_punctual", "KHR_materials_clearcoat", "KHR_materials_transmission"])");
    replace("\"materials\":",
            R"("textures": [{"source": 0}, {"source": 1}],
               "images": [{"uri": "parts.png"}, {"uri": "normals.png"}], "materials":)");
    replace(R"("metallicFactor": 0, "roughnessFactor": 0.6})",
            R"("metallicRoughnessTexture": {"index": 0}}, "normalTexture": {"index": 1},
               "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.5,
                              "clearcoatRoughnessFactor": 0.2}})");
    replace(R"("metallicFactor": 1, "roughnessFactor": 0.7})",
            R"("metallicFactor": 0, "roughnessFactor": 0.3},
               "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75}})");
    write("model.gltf", text);
    write("model.bin", gltf_buffer());
    write_png(folder / "parts.png",
              {.width = 1, .height = 1, .pixels = {0, 102, 51}});  // roughness 0.4, metal 0.2
    write_png(folder / "normals.png", {.width = 1, .height = 1, .pixels = {168, 128, 238}});
    expect_words(run({"import", "model.gltf"}), {"the clear coat is a quarter as strong"});
    const std::string paint =
        "<bsdf type='normalmap'><texture type='bitmap' name='normalmap'>"
        "<string name='filename' value='normals.png'/><boolean name='raw' value='true'/></texture>"
        "<bsdf type='principled'><rgb name='base_color' value='0.5, 0.4, 0.3'/>"
        "<float name='roughness' value='0.4'/><float name='metallic' value='0.2'/>"
        "<float name='clearcoat' value='0.5'/>"
        "<float name='clearcoat_gloss' value='0.60606061'/></bsdf></bsdf>";
    const std::string glass =
        "<bsdf type='principled'><rgb name='base_color' value='0.6, 0.6, 0.7'/>"
        "<float name='roughness' value='0.3'/><float name='spec_trans' value='0.75'/></bsdf>";
    // The tangents of a mesh without texture coordinates are its own.
    const std::string floor =
        "<shape type='ply'><string name='filename' value='model_files/plane.ply'/>"
        "<transform name='to_world'><scale x='2' z='2'/></transform>"
        "<bsdf type='twosided'>" +
        paint + "</bsdf></shape>";
    expect_same_picture(eye(gltf_view) + floor +
                        square(1, "<translate x='0.5' y='0.5'/>", glass, false) + lamp);
}

TEST_F(Import, gltf_colours_of_vertices) {
    std::string text = gltf_model;
    const auto replace = [&](const std::string& from, const std::string& to) {
        ASSERT_NE(text.find(from), std::string::npos);
        text.replace(text.find(from), from.size(), to);
    };
    // The floor, whose material is white then, and not the step.
    replace(R"("POSITION": 0})", R"("POSITION": 0, "COLOR_0": 2})");
    replace("[0.5, 0.4, 0.3, 1]", "[0.5, 0.5, 0.5, 1]");
    replace(R"("type": "SCALAR"})",
            R"("type": "SCALAR"}, {"bufferView": 2, "componentType": 5126, "count": 4,
               "type": "VEC3"})");
    replace(R"("byteLength": 12})",
            R"("byteLength": 12}, {"buffer": 0, "byteOffset": 60, "byteLength": 48})");
    replace(R"("byteLength": 60,)", R"("byteLength": 108,)");
    std::string buffer = gltf_buffer();
    for (const float x : {0.2f, 0.4f, 0.6f, 0.2f, 0.4f, 0.6f, 0.8f, 0.4f, 0.1f, 0.8f, 0.4f, 0.1f}) {
        const auto bits = std::bit_cast<std::uint32_t>(x);
        for (int i = 0; i < 4; ++i) buffer += static_cast<char>(bits >> (8 * i) & 255);
    }
    write("model.gltf", text);
    write("model.bin", buffer);
    expect_words(run({"import", "model.gltf"}), {"vertex colours"});
    // Corners in the order of the file; a fan of two triangles.
    write("floor.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
          "property float z\nproperty float r\nproperty float g\nproperty float b\n"
          "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
          "-2 0 -2 0.1 0.2 0.3\n-2 0 2 0.1 0.2 0.3\n2 0 2 0.4 0.2 0.05\n2 0 -2 0.4 0.2 0.05\n"
          "3 0 1 2\n3 0 2 3\n");
    const std::string floor =
        "<shape type='ply'><string name='filename' value='floor.ply'/><bsdf type='twosided'>"
        "<bsdf type='principled'><texture type='mesh_attribute' name='base_color'>"
        "<string name='name' value='vertex_color'/></texture>"
        "<float name='roughness' value='0.6'/><float name='metallic' value='0'/></bsdf></bsdf>"
        "</shape>";
    expect_same_picture(
        eye(gltf_view) + floor +
        square(1, "<translate x='0.5' y='0.5'/>", principled("0.6, 0.6, 0.7", 0.7, 1)) + lamp);
}

TEST_F(Import, gltf_pictures_lie_where_their_transform_puts_them) {
    // Eight texels in a row, green between 3/8 and 7/8; the rest is red.
    Image8 row{.width = 8, .height = 1, .pixels = {}};
    for (int i = 0; i < 8; ++i) {
        const bool green = i >= 3 && i <= 6;
        for (const int v : {green ? 0 : 255, green ? 255 : 0, 0}) {
            row.pixels.push_back(static_cast<std::uint8_t>(v));
        }
    }
    write_png(folder / "row.png", row);
    std::string buffer = gltf_buffer();
    for (const float x : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f, 1.f, 0.f}) {
        const auto bits = std::bit_cast<std::uint32_t>(x);
        for (int i = 0; i < 4; ++i) buffer += static_cast<char>(bits >> (8 * i) & 255);
    }
    write("model.bin", buffer);
    // Both show the part from u = 1/2 to 3/4 only; the second turns v into u.
    for (const char* transform :
         {R"("scale": [0.25, 1], "offset": [0.5, 0])",
          R"("scale": [1, 0.25], "rotation": 1.5707963267948966, "offset": [0.5, 0])"}) {
        SCOPED_TRACE(transform);
        std::string text = gltf_model;
        const auto replace = [&](const std::string& from, const std::string& to) {
            ASSERT_NE(text.find(from), std::string::npos);
            text.replace(text.find(from), from.size(), to);
        };
        replace(R"(["KHR_lights_punctual"])",
                R"(["KHR_lights_punctual", "KHR_texture_transform"])");
        replace("\"materials\":",
                R"("textures": [{"source": 0}], "images": [{"uri": "row.png"}], "materials":)");
        replace(R"("baseColorFactor": [0.5, 0.4, 0.3, 1],)",
                fmt::format(R"("baseColorTexture": {{"index": 0, "extensions":
                    {{"KHR_texture_transform": {{{}}}}}}},)",
                            transform));
        replace(R"({"POSITION": 0}, "indices": 1,
   "material": 0})",
                R"({"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0})");
        replace(R"("type": "SCALAR"})", R"("type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"})");
        replace(R"("byteLength": 12})", R"("byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 32})");
        replace(R"("byteLength": 60)", R"("byteLength": 92)");
        write("model.gltf", text);
        run({"import", "model.gltf", "--force"});
        expect_same_picture(
            eye(gltf_view) + square(2, "", principled("0, 1, 0", 0.6, 0)) +
            square(1, "<translate x='0.5' y='0.5'/>", principled("0.6, 0.6, 0.7", 0.7, 1)) + lamp);
    }
}

TEST_F(Import, tells_what_it_drops) {
    write("model.obj", obj_model);
    write("model.mtl", std::string(mtl) + "map_Kd lost.png\nmap_bump bumps.png\n");
    expect_words(run({"import", "model.obj"}),
                 {"dropped       picture   lost.png", "there is no such file", "of heights"});
    EXPECT_TRUE(fs::exists(folder / "model_files/floor.ply"));
}

TEST_F(Import, overwrites_nothing_unless_forced) {
    write("model.obj", obj_model);
    write("model.mtl", mtl);
    write("model.xml", "precious");
    run({"import", "model.obj"}, exit_code::file);
    expect_words(errors, {"model.xml is there already", "--force"});
    EXPECT_EQ(read_whole(folder / "model.xml"), "precious");
    EXPECT_FALSE(fs::exists(folder / "model_files"));
    run({"import", "model.obj", "--force"});
    EXPECT_NE(read_whole(folder / "model.xml"), "precious");
}

TEST_F(Import, refuses_what_is_no_model) {
    run({"import", "nothing.dae"}, exit_code::file);
    expect_words(errors, {"nothing.dae: there is no such file"});
    write("model.gltf", "{\"asset\": ");
    run({"import", "model.gltf"}, exit_code::file);
    expect_words(errors, {"model.gltf cannot be read as a model"});
    write("empty.obj", "# nothing\n");
    run({"import", "empty.obj"}, exit_code::file);
    run({"import", "model.gltf", "-o", "scene.txt"}, exit_code::usage);
    write("model.fbx", "");
    run({"import", "model.fbx"}, exit_code::file);
    expect_words(errors, {"only .dae, .gltf, .glb and .obj can be imported"});
    EXPECT_FALSE(fs::exists(folder / "model.xml"));
}

}  // namespace
}  // namespace lucerna
