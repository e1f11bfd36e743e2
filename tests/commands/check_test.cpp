// SPDX-License-Identifier: Apache-2.0
/// `lucerna check`: all plugins of the program pass, faulty ones do not, and wrong arguments are
/// told exactly. The faulty ones are in the folder `faulty` beside this file.
#include "core/base/error.h"
#include "core/image/png.h"
#include "core/plugin/registry.h"
#include "tests/commands/process.h"
#include "tests/measured_writer.h"
#include "tests/vol_writer.h"

#include <gmock/gmock.h>

#include <map>

namespace lucerna {
namespace {

using testing::HasSubstr;

struct Outcome {
    int code;
    std::string output, errors;
};

class CheckCommandTest : public testing::Test {
protected:
    static void SetUpTestSuite() {
        folder = new TemporaryFolder;
        std::ofstream(*folder / "roof.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 1 1\n"
                                               "f 1 2 3\nf 2 4 3\n";
        write_png(*folder / "grey.png",
                  {.width = 2, .height = 1, .pixels = {90, 120, 200, 30, 30, 10}});
        write_bytes(*folder / "copper.bsdf",
                    tensor_bytes(measured({.reflectance = {0.9f, 0.6f, 0.5f}}, {})));
    }
    static void TearDownTestSuite() { delete folder; }

    static Outcome check(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "check");
        Process process(folder->path(), arguments);
        const int code = process.wait();
        return {code, process.output(), process.errors()};
    }
    /// Of a plugin that is made wrong on purpose.
    static Outcome check_faulty(const std::string& plugin) {
        const auto faulty = program_path().parent_path().parent_path() / "tests" / "faulty";
        return check({plugin, "--plugins", faulty.string()});
    }

    static inline TemporaryFolder* folder = nullptr;
};

/// What plugins cannot be made without; empty: it has nothing to be checked by itself.
const std::map<std::string, std::vector<std::string>> needs = {
    {"bsdf/blendbsdf", {"--inside", "<bsdf type='diffuse'/><bsdf type='dielectric'/>"}},
    {"bsdf/bumpmap", {"texture=checkerboard", "bsdf=diffuse"}},
    {"bsdf/mask", {"bsdf=diffuse", "opacity=0.3"}},
    {"bsdf/normalmap",
     {"--inside",
      "<texture name='normalmap' type='rawconstant'><vector name='value' value='0.7, 0.5, 0.8'/>"
      "</texture><bsdf type='diffuse'/>"}},
    {"bsdf/measured", {"filename=copper.bsdf"}},
    {"bsdf/twosided", {"bsdf=plastic"}},
    {"emitter/envmap", {"filename=grey.png"}},
    {"emitter/sunsky", {"sun_aperture=20"}},  // or few rays meet the sun by chance
    {"phase/blendphase", {"--inside", "<phase type='sggx'/><phase type='hg'/>", "weight=0.3"}},
    {"sensor/thinlens", {"aperture_radius=0.1", "focus_distance=3"}},
    {"bsdf/hair", {}},  // the adjoint over the width of a fibre only, not at each point
    {"shape/bsplinecurve", {}},
    {"shape/city", {"part=walls", "size=1"}},
    {"shape/instance", {}},
    {"shape/linearcurve", {}},
    {"shape/merge", {}},
    {"shape/obj", {"filename=roof.obj"}},
    {"shape/ply", {}},  // as the next one: a reader of files of another format for the same meshes
    {"shape/sdfgrid", {}},  // its area is not known
    {"shape/serialized", {}},
    {"shape/shapegroup", {}},
    {"texture/bitmap", {"filename=grey.png"}},
    {"texture/mesh_attribute", {"name=vertex_color"}},
    {"texture/rawconstant", {"value=0.3"}},
};

TEST_F(CheckCommandTest, all_plugins_keep_their_contracts) {
    int checked = 0;
    for (const char* kind : {"bsdf", "light_sampler", "shape", "emitter", "texture", "phase",
                             "sensor", "sampler", "rfilter"}) {
        for (const std::string& name : Registry().names(kind)) {
            const std::string plugin = std::string(kind) + "/" + name;
            const auto found = needs.find(plugin);
            if (found != needs.end() && found->second.empty()) continue;
            std::vector<std::string> arguments = {plugin, "--samples", "100000"};
            if (found != needs.end()) {
                arguments.insert(arguments.end(), found->second.begin(), found->second.end());
            }
            const Outcome outcome = check(arguments);
            EXPECT_EQ(outcome.code, 0) << plugin << "\n" << outcome.output << outcome.errors;
            EXPECT_THAT(outcome.output, HasSubstr("\n0 of ")) << plugin;
            ++checked;
        }
    }
    EXPECT_GE(checked, 50);
}

TEST_F(CheckCommandTest, density_that_is_two_percent_off_is_found) {
    const Outcome outcome = check_faulty("bsdf/wrong_density");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("density is normalized .*BROKEN"));
    EXPECT_THAT(outcome.output, testing::ContainsRegex("directions follow .*BROKEN"));
    EXPECT_THAT(outcome.output, HasSubstr("the density integrates to 0.98000, 1.00000 of"));
    EXPECT_THAT(outcome.output, HasSubstr("\n2 of "));
}

TEST_F(CheckCommandTest, light_sampler_that_forgets_lights_is_found) {
    const Outcome outcome = check_faulty("light_sampler/blind_spot");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("pmf is positive .*BROKEN"));
    EXPECT_THAT(outcome.output, HasSubstr("and is never drawn there"));
}

TEST_F(CheckCommandTest, light_that_is_lost_by_its_weights_is_found) {
    const Outcome outcome = check_faulty("light_sampler/lost_light");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("as often as their weights say .*BROKEN"));
}

TEST_F(CheckCommandTest, phase_that_loses_light_is_found) {
    const Outcome outcome = check_faulty("phase/absorbing");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("no light is lost or gained .*BROKEN"));
    EXPECT_THAT(outcome.output, testing::ContainsRegex("0\\.9[78][0-9]* ± .*, expected 1"));
    EXPECT_THAT(outcome.output, testing::ContainsRegex("scattering is reciprocal .*BROKEN"));
    EXPECT_THAT(outcome.output, HasSubstr("\n2 of 8 "));
}

TEST_F(CheckCommandTest, wrong_area_is_found) {
    const Outcome outcome = check_faulty("shape/wrong_area");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("areas are those .*BROKEN"));
    EXPECT_THAT(outcome.output, HasSubstr("expected 4.12 m² in all"));
}

TEST_F(CheckCommandTest, particles_that_carry_too_much_are_found) {
    const Outcome outcome = check_faulty("emitter/bright_particles");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_THAT(outcome.output, testing::ContainsRegex("particles carry the power .*BROKEN"));
}

TEST_F(CheckCommandTest, element_of_a_scene_is_checked) {
    std::ofstream(*folder / "red.xml")
        << "<scene version='3.0.0'><bsdf type='diffuse' id='red'><rgb name='reflectance' "
           "value='0.9 0.1 0.1'/></bsdf></scene>";
    EXPECT_EQ(check({"red", "--scene", "red.xml", "--samples", "20000"}).code, 0);
    const Outcome unknown = check({"rde", "--scene", "red.xml"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.errors, HasSubstr("has no element with the id \"rde\"; did you mean "
                                          "\"red\"?\n  there are red"));
}

TEST_F(CheckCommandTest, picture_shows_what_is_sampled) {
    for (const auto& [plugin, width] : {std::pair{"bsdf/roughconductor", 1472},
                                        {"phase/hg", 1472},
                                        {"light_sampler/power", 0},
                                        {"shape/sphere", 984},
                                        {"emitter/spot", 0},
                                        {"texture/checkerboard", 496},
                                        {"sensor/perspective", 984},
                                        {"sampler/sobol", 1472},
                                        {"rfilter/mitchell", 496}}) {
        ASSERT_EQ(check({plugin, "--samples", "20000", "--picture", "out.png"}).code, 0) << plugin;
        const Image picture = read_png(*folder / "out.png");
        if (width > 0) {
            EXPECT_EQ(picture.width, width) << plugin;
        }
        EXPECT_GT(*std::max_element(picture.pixels.begin(), picture.pixels.end()), 0.5f) << plugin;
        std::filesystem::remove(*folder / "out.png");
    }
}

TEST_F(CheckCommandTest, wrong_arguments_are_told) {
    const auto errors = [](int code, std::vector<std::string> arguments) {
        const Outcome outcome = check(std::move(arguments));
        EXPECT_EQ(outcome.code, code);
        return outcome.errors;
    };
    EXPECT_EQ(errors(2, {"diffuse"}),
              "lucerna check: expected a kind and a name, like bsdf/diffuse, not \"diffuse\"\n"
              "  kinds are bsdf, light_sampler, shape, emitter, texture, phase, sensor, sampler, "
              "rfilter\n");
    EXPECT_THAT(errors(2, {"bdsf/diffuse"}),
                HasSubstr("there is no kind of plugin \"bdsf\"; did you mean \"bsdf\"?"));
    EXPECT_THAT(errors(2, {"integrator/path"}),
                HasSubstr("there are no contracts to check for kind \"integrator\""));
    EXPECT_THAT(errors(2, {"bsdf/difuse"}), HasSubstr("did you mean \"diffuse\"?"));
    EXPECT_THAT(errors(3, {"bsdf/diffuse", "reflectence=0.5"}), HasSubstr("argument:1:1: error: "));
    EXPECT_THAT(errors(3, {"bsdf/diffuse", "reflectence=0.5"}),
                HasSubstr("did you mean \"reflectance\"?"));
    EXPECT_THAT(errors(3, {"bsdf/diffuse", "reflectance=2"}), HasSubstr("argument:1:1: error: "));
    EXPECT_THAT(errors(3, {"bsdf/diffuse", "0.5"}),
                HasSubstr("argument:1:1: error: expected name=value, like radius=2"));
    EXPECT_THAT(errors(3, {"bsdf/mask", "--inside", "<bsdf type='difuse'/>"}),
                HasSubstr("--inside:2:1: error: "));
    EXPECT_THAT(errors(2, {"shape/shapegroup", "--inside", "<shape type='sphere'/>"}),
                HasSubstr("has no surface of its own"));
    EXPECT_THAT(errors(2, {"bsdf/diffuse", "--samples", "10"}), HasSubstr("--samples"));
}

}  // namespace
}  // namespace lucerna
