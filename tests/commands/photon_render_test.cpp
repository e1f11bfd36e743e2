// SPDX-License-Identifier: Apache-2.0
/// `lucerna render` with photons: checkpoints, signals, and lights that are not finite.
#include "tests/commands/render_command.h"

#include <limits>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

class PhotonRenderTest : public RenderCommandTest, public testing::WithParamInterface<const char*> {
protected:
    /// Options that choose the integrator, with few photons, and others after them.
    static std::vector<std::string> with(const std::vector<std::string>& options) {
        const std::string name = GetParam();
        std::vector<std::string> words = {"--set", "integrator=" + name};
        const auto set = [&](const char* parameter) {
            words.insert(words.end(), {"--set", std::string("integrator.") + parameter});
        };
        if (name == "photonmap") {
            set("global_photons=5000");
            set("caustic_photons=1000");
        }
        if (name == "sppm") set("photon_count=5000");
        words.insert(words.end(), options.begin(), options.end());
        return words;
    }
};

TEST_P(PhotonRenderTest, N10_ResumingDoesNotChangeTheImage) {
    render(with({"-q", "-o", "whole", "--spp", "8"}));
    render(with({"-q", "-o", "part", "--spp", "4", "--checkpoint", "state.exr"}));
    EXPECT_FALSE(plane("whole.exr") == plane("part.exr"));
    render(with({"-q", "-o", "part", "--spp", "8", "--checkpoint", "state.exr", "--resume"}));
    for (const char* channel : {"R", "G", "B"}) {
        EXPECT_TRUE(plane("whole.exr", channel) == plane("part.exr", channel));
    }
}

TEST_P(PhotonRenderTest, H9_crop_is_cut_out_of_the_whole_image) {
    render(with({"-q", "-o", "whole", "--resolution", "40x30", "--spp", "4"}));
    render(with({"-q", "-o", "part", "--resolution", "40x30", "--spp", "4", "--crop", "5,7,11,9"}));
    for (const char* channel : {"R", "G", "B"}) {
        const std::vector<float> whole = plane("whole.exr", channel);
        const std::vector<float> part = plane("part.exr", channel);
        ASSERT_EQ(part.size(), 99u);
        for (std::size_t i = 0; i < part.size(); ++i) {
            EXPECT_EQ(part[i], whole[(7 + i / 11) * 40 + 5 + i % 11]) << channel << ' ' << i;
        }
    }
}

TEST_P(PhotonRenderTest, N1_N10_ASignalInTheMiddleLeavesWhatCanBeResumed) {
    const std::unique_ptr<Process> process = start_endless(with({}));
    process->kill(SIGINT);
    EXPECT_EQ(process->wait(), exit_code::interrupted) << process->errors();
    EXPECT_EQ(plane("scene.exr").size(), 40000u);
    expect_no_leftovers();

    const auto& metadata = read_exr(folder / "scene.exr").metadata;
    const int done = std::stoi(std::get<std::string>(metadata.at("lucerna:samples_per_pixel")));
    EXPECT_GT(done, 0);
    const std::vector<std::string> rest = {"-q", "--resolution", "200x200", "--spp",
                                           std::to_string(done + 2)};
    render(with(rest));
    const std::vector<float> whole = plane("scene.exr");
    std::vector<std::string> resumed = rest;
    resumed.insert(resumed.end(), {"--checkpoint", "state.exr", "--resume"});
    render(with(resumed));
    EXPECT_TRUE(whole == plane("scene.exr"));
}

/// Lights that are too bright for the power of a photon to be a float, among others that are not.
TEST_P(PhotonRenderTest, PowerThatIsNotFiniteIsRefusedWithItsOrigin) {
    std::string scene = small_scene;
    scene.insert(scene.rfind("</scene>"), R"(
    <default name="point" value="1"/>
    <emitter type="point">
        <point name="position" x="1" y="2" z="3"/>
        <float name="intensity" value="$point"/>
    </emitter>
    <default name="area" value="1"/>
    <shape type="disk">
        <transform name="to_world"><scale value="2"/><translate z="-7"/></transform>
        <emitter type="area"><float name="radiance" value="$area"/></emitter>
    </shape>)");
    write("scene.xml", scene);
    render(with({"-q", "--checkpoint", "state.exr"}));
    const std::string picture = read_whole(folder / "scene.exr");
    const std::string state = read_whole(folder / "state.exr");
    const auto expect_refusal = [&](const char* light) {
        render(with({"-q", "--checkpoint", "state.exr", "-D", light}), exit_code::scene);
        EXPECT_TRUE(read_whole(folder / "scene.exr") == picture);
        EXPECT_TRUE(read_whole(folder / "state.exr") == state);
        expect_no_leftovers();
    };
    expect_refusal("point=1e38");
    EXPECT_EQ(errors,
              "error: light number 1 of the scene, at (1, 2, 3), emits photons of a power that is "
              "not finite\n");
    expect_refusal("area=3e38");
    expect_error("error: light number 2 of the scene, at (");
    expect_error("emits photons of a power that is not finite");
}

/// Texels of a light that are no numbers are told, and give no light.
TEST_P(PhotonRenderTest, C15_TexelsThatAreNotFiniteAreDarkAndTold) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float inf = std::numeric_limits<float>::infinity();
    const auto write_texels = [&](float first, float second) {
        ImageFile texels;
        texels.width = texels.full_width = 2;
        texels.height = texels.full_height = 2;
        for (const char* name : {"R", "G", "B"}) {
            texels.planes.push_back({name, std::vector<float>{first, second, 1, 2}});
        }
        write_exr(folder / "light.exr", texels);
    };
    std::string scene = small_scene;
    scene.insert(scene.rfind("</scene>"), R"(
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><translate y="2"/></transform>
        <emitter type="area">
            <texture type="bitmap" name="radiance">
                <string name="filename" value="light.exr"/>
            </texture>
        </emitter>
    </shape>)");
    write("scene.xml", scene);
    write_texels(0, 0);
    render(with({"-q", "-o", "dark"}));
    write_texels(nan, inf);
    render(with({"-q", "-o", "told"}));
    expect_error("light.exr: 2 pixels are not finite");
    EXPECT_TRUE(plane("told.exr") == plane("dark.exr"));
}

using PhotonMapRender = RenderCommandTest;

TEST_F(PhotonMapRender, WarningsTellWhichPhotonsAreMissing) {
    // A floor alone: all photons meet it, but none a second surface.
    write("scene.xml", R"(<scene version="3.0.0"><integrator type="photonmap"/>
<sensor type="perspective"><transform name="to_world">
    <lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film>
</sensor>
<shape type="rectangle"/>
<emitter type="point"><point name="position" value="0, 0, 1"/><float name="intensity" value="1"/>
</emitter></scene>)");
    render({"-q", "--spp", "1"});
    expect_error("photons none met a diffuse surface after another\n");
}

INSTANTIATE_TEST_SUITE_P(All, PhotonRenderTest, testing::Values("photonmap", "sppm", "ptracer"),
                         [](const auto& one) { return std::string(one.param); });

/// A render that has no sample yet leaves the picture and the checkpoint of an earlier one.
TEST_F(RenderCommandTest, N1_ASignalBeforeTheFirstSampleWritesNothing) {
    render({"-q", "--checkpoint", "state.exr"});
    const std::string picture = read_whole(folder / "scene.exr");
    const std::string state = read_whole(folder / "state.exr");
    // Its photons take minutes. A parameter without effect is told just before it begins.
    Process process(
        folder.path(),
        {"render", "scene.xml", "-q", "--checkpoint", "state.exr", "--set", "integrator=photonmap",
         "--set", "integrator.global_photons=100000000", "--set", "integrator.granularity=1"});
    for (int i = 0; i < 1000 && process.errors().empty(); ++i) {
        std::this_thread::sleep_for(milliseconds(20));
    }
    std::this_thread::sleep_for(milliseconds(300));
    process.kill(SIGINT);
    EXPECT_EQ(process.wait(), exit_code::interrupted) << process.errors();
    EXPECT_NE(process.errors().find("before the first sample"), std::string::npos);
    EXPECT_TRUE(read_whole(folder / "scene.exr") == picture);
    EXPECT_TRUE(read_whole(folder / "state.exr") == state);
    expect_no_leftovers();
}

}  // namespace
}  // namespace lucerna
