// SPDX-License-Identifier: Apache-2.0
/// `lucerna render` as users run it: files, exit codes, signals, full disks.
#include "tests/commands/render_command.h"
#include "core/base/error.h"
#include "core/image/png.h"
#include "core/interfaces/command.h"

#include <chrono>
#include <thread>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

TEST_F(RenderCommandTest, writes_both_pictures_and_tells_the_figures) {
    const std::string output = render({});
    for (const char* word : {"load ", "build ", "render ", "4 spp", "Mrays/s", "relMSE ", "95 %",
                             "scene.exr", "scene.png"}) {
        EXPECT_NE(output.find(word), std::string::npos) << output;
    }
    const ImageFile file = read_exr(folder / "scene.exr");
    for (const char* name :
         {"lucerna:command", "lucerna:seed", "lucerna:samples_per_pixel", "lucerna:render_seconds",
          "lucerna:scene_hash", "lucerna:version", "lucerna:built_with", "lucerna:relative_mse",
          "lucerna:relative_mse_low", "lucerna:relative_mse_high"}) {
        EXPECT_TRUE(file.metadata.contains(name)) << name;
    }
    EXPECT_EQ(read_png(folder / "scene.png").channel_count(), 3u);
    expect_no_leftovers();
}

/// The C library has other versions of its functions for older processors.
TEST_F(RenderCommandTest, N9_TheImageDoesNotDependOnTheVersionOfMathFunctions) {
    render({"-q", "-o", "new"});
    render({"-q", "-o", "old"}, exit_code::success,
           {.environment = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2,-AVX"});
    for (const char* channel : {"R", "G", "B"}) {
        EXPECT_EQ(plane("new.exr", channel), plane("old.exr", channel)) << channel;
    }
}

TEST_F(RenderCommandTest, output_may_have_either_extension_or_none) {
    for (const char* name : {"a.exr", "b.png", "c", "d.v2"})
        render({"-q", "--spp", "1", "-o", name});
    for (const char* name : {"a.exr", "a.png", "b.exr", "b.png", "c.exr", "c.png", "d.v2.exr"}) {
        EXPECT_TRUE(fs::exists(folder / name)) << name;
    }
}

TEST_F(RenderCommandTest, a_film_of_another_kind_is_a_third_picture) {
    const std::string output =
        render({"--spp", "1", "-o", "a.pfm", "--set", "sensor.film.file_format=pfm"});
    for (const char* name : {"a.exr", "a.png", "a.pfm"}) {
        EXPECT_TRUE(fs::exists(folder / name)) << name;
        EXPECT_NE(output.find(name), std::string::npos) << output;
    }
    EXPECT_TRUE(read_exr(folder / "a.exr").plane("A"));
}

TEST_F(RenderCommandTest, scene_can_be_changed) {
    render({"-q", "--resolution", "20x10", "--set", "integrator.max_depth=2", "-D", "spp=2"});
    EXPECT_EQ(read_exr(folder / "scene.exr").width, 20);
    render({"-q", "-o", "dark", "-D", "radiance=0", "-D", "spp=1"});
    for (const float x : plane("dark.exr")) EXPECT_EQ(x, 0);
}

TEST_F(RenderCommandTest, resolution_of_a_scene_without_a_film) {
    write("scene.xml",
          "<scene version='3.0.0'><sensor type='perspective'/><shape type='sphere'/></scene>");
    render({"-q", "--resolution", "20x10", "--spp", "1"});
    const ImageFile picture = read_exr(folder / "scene.exr");
    EXPECT_EQ(picture.width, 20);
    EXPECT_EQ(picture.height, 10);
}

TEST_F(RenderCommandTest, json_holds_the_figures) {
    const std::string output = render({"--json", "--seed", "12"});
    for (const char* word : {"\"schema\": 1", "\"samples_per_pixel\": 4", "\"seed\": 12",
                             "\"relative_mse\": ", "\"dropped_samples\": 0"}) {
        EXPECT_NE(output.find(word), std::string::npos) << word << output;
    }
    EXPECT_EQ(output.front(), '{');
}

TEST_F(RenderCommandTest, quiet_prints_nothing) {
    EXPECT_EQ(render({"--quiet"}), "");
    EXPECT_EQ(errors, "");
}

TEST_F(RenderCommandTest, P9_a_scene_without_light_is_told_once_it_is_black) {
    std::string scene = small_scene;
    for (std::size_t at; (at = scene.find("<emitter")) != std::string::npos;) {
        const std::string_view end = "</emitter>";
        scene.erase(at, scene.find(end, at) + end.size() - at);
    }
    write("scene.xml", scene);
    render({"-q", "--spp", "1"});
    EXPECT_EQ(errors, "warning: the picture is black: the scene has no light; add an <emitter>\n");
    render({"-q", "--spp", "1", "--set", "integrator=depth"});
    EXPECT_EQ(errors, "");
}

TEST_F(RenderCommandTest, H9_crop_is_cut_out_of_the_whole_image) {
    render({"-q", "-o", "whole"});
    render({"-q", "-o", "part", "--crop", "5,7,10,8"});
    const std::vector<float> whole = plane("whole.exr"), part = plane("part.exr");
    ASSERT_EQ(part.size(), 80u);
    for (std::size_t i = 0; i < part.size(); ++i) {
        EXPECT_EQ(part[i], whole[i % 10 + 5 + 32 * (i / 10 + 7)]);
    }
    const ImageFile file = read_exr(folder / "part.exr");
    EXPECT_EQ(file.x, 5);
    EXPECT_EQ(file.full_width, 32);
}

TEST_F(RenderCommandTest, N8_threads_do_not_change_the_image) {
    render({"-q", "-o", "one", "--threads", "1"});
    for (const char* threads : {"2", "3", "8", "64"}) {
        render({"-q", "-o", "many", "--threads", threads});
        EXPECT_EQ(plane("one.exr"), plane("many.exr")) << threads;
    }
}

TEST_F(RenderCommandTest, N10_resuming_does_not_change_the_image) {
    render({"-q", "-o", "whole", "--spp", "64"});
    render({"-q", "-o", "part", "--spp", "16", "--checkpoint", "state.exr"});
    EXPECT_NE(plane("whole.exr"), plane("part.exr"));
    render({"-q", "-o", "part", "--spp", "64", "--checkpoint", "state.exr", "--resume"});
    EXPECT_EQ(plane("whole.exr"), plane("part.exr"));
    render({"-o", "again", "--spp", "64", "--checkpoint", "state.exr", "--resume"});
    expect_error("nothing is left to render");
    EXPECT_EQ(plane("whole.exr"), plane("again.exr"));
}

TEST_F(RenderCommandTest, N13_resuming_another_render_is_refused) {
    const std::vector<std::string> state = {"-q", "--checkpoint", "state.exr"};
    const auto with = [&](std::vector<std::string> words) {
        words.insert(words.end(), state.begin(), state.end());
        return words;
    };
    render(with({}));
    const std::string before = read_whole(folder / "state.exr");
    render(with({"--resume", "--seed", "1"}), exit_code::failure);
    expect_error("--seed");
    render(with({"--resume", "--resolution", "8x8"}), exit_code::failure);
    expect_error("32 × 24 pixels");
    render(with({"--resume", "-D", "radiance=2"}), exit_code::failure);
    expect_error("another scene");
    write("state.exr", before.substr(0, before.size() / 2));
    render(with({"--resume"}), exit_code::file);
}

TEST_F(RenderCommandTest, N13_a_changed_mesh_is_another_scene) {
    const auto triangle = [](const char* height) {
        return "v 0 0 0\nv 1 0 0\nv 0 " + std::string(height) + " 0\nf 1 2 3\n";
    };
    std::string scene = small_scene;
    const std::string mesh =
        R"(<shape type="obj"><string name="filename" value="mesh.obj"/></shape>)";
    write("scene.xml", scene.insert(scene.rfind("</scene>"), mesh));
    write("mesh.obj", triangle("1"));
    render({"-q", "--checkpoint", "state.exr"});
    render({"-q", "--checkpoint", "state.exr", "--resume"});
    write("mesh.obj", triangle("2"));
    render({"-q", "--checkpoint", "state.exr", "--resume"}, exit_code::failure);
    expect_error("another scene");
}

TEST_F(RenderCommandTest, resume_without_a_checkpoint_begins_and_says_so) {
    render({"--checkpoint", "state.exr", "--resume"});
    expect_error("not there yet");
    EXPECT_TRUE(fs::exists(folder / "state.exr"));
}

TEST_F(RenderCommandTest, N14_time_and_error_limits) {
    const auto start = std::chrono::steady_clock::now();
    render({"--time", "0.5"});
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    const std::string output = render({"--error", "0.01", "--spp", "100000"});
    EXPECT_EQ(output.find("100000 spp"), std::string::npos) << output;
}

TEST_F(RenderCommandTest, exit_codes) {
    render({"--tiem", "3"}, exit_code::usage);
    expect_error("did you mean \"--time\"?");
    render({"--resume"}, exit_code::usage);
    render({"--checkpoint", "scene.exr"}, exit_code::usage);
    expect_error("would replace the checkpoint");
    render({"--view", "nothing"}, exit_code::scene);
    render({"--set", "integrator.max_dept=3"}, exit_code::scene);
    expect_error("max_depth");
    render({"--set", "integrator=paht"}, exit_code::scene);
    render({"-o", "no/such/folder/x"}, exit_code::file);
    write("scene.xml", "<scene");
    render({}, exit_code::scene);
    fs::remove(folder / "scene.xml");
    EXPECT_NE(Process(folder.path(), {"render", "scene.xml"}).wait(), exit_code::success);
}

TEST_F(RenderCommandTest, M1_broken_plugin_has_its_own_exit_code) {
    fs::create_directories(folder / "plugins/integrators");
    write("plugins/integrators/path.so", "not a library");
    render({"--plugins", "plugins"}, exit_code::plugin);
    expect_error("path.so");
    render({}, exit_code::plugin, {.environment = "LUCERNA_PLUGINS=plugins"});
}

TEST_F(RenderCommandTest, N1_signals_end_the_render_with_its_pictures) {
    for (const int signal : {SIGINT, SIGTERM}) {
        fs::remove(folder / "state.exr");
        fs::remove(folder / "scene.exr");
        const std::unique_ptr<Process> process = start_endless();
        const auto start = std::chrono::steady_clock::now();
        process->kill(signal);
        EXPECT_EQ(process->wait(), exit_code::interrupted);
        // Two seconds on a machine of one's own; tests share theirs.
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
        EXPECT_NE(process->output().find("interrupted"), std::string::npos);
        EXPECT_EQ(plane("scene.exr").size(), 40000u);
        EXPECT_EQ(read_exr(folder / "state.exr").width, 200);
        expect_no_leftovers();
    }
}

TEST_F(RenderCommandTest, N2_no_file_is_ever_half_written) {
    for (int i = 0; i < 12; ++i) {
        const std::unique_ptr<Process> process = start_endless();
        std::this_thread::sleep_for(milliseconds(7 * i));
        process->kill(SIGKILL);
        EXPECT_EQ(process->wait(), 128 + SIGKILL);
        EXPECT_EQ(read_exr(folder / "state.exr").width, 200);
    }
}

TEST_F(RenderCommandTest, N3_N5_full_disk_leaves_the_old_picture) {
    render({"-q"});
    const std::string before = read_whole(folder / "scene.exr");
    render({"-q", "--resolution", "200x200"}, exit_code::file, {.largest_file = 4096});
    expect_error("scene.exr");
    EXPECT_EQ(read_whole(folder / "scene.exr"), before);
    expect_no_leftovers();
}

TEST_F(RenderCommandTest, N4_full_disk_is_noticed_for_small_files) {
    fs::create_symlink("/dev/full", folder / "full.exr");
    render({"-q", "--resolution", "8x8", "-o", "full"}, exit_code::file);
    expect_error("full.exr");
}

TEST_F(RenderCommandTest, N6_output_is_checked_before_rendering) {
    const auto start = std::chrono::steady_clock::now();
    render({"--time", "60", "-o", "no/such/folder/x"}, exit_code::file);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    fs::create_directory(folder / "taken.exr");
    render({"--time", "60", "-o", "taken"}, exit_code::file);
    render({"--time", "60", "--checkpoint", "no/such/folder/x.exr"}, exit_code::file);
}

TEST_F(RenderCommandTest, N12_two_renders_to_one_file_leave_one_of_both) {
    render({"-q", "-o", "first", "--seed", "1"});
    render({"-q", "-o", "second", "--seed", "2"});
    for (int i = 0; i < 8; ++i) {
        const auto begin = [&](const char* seed) {
            return std::make_unique<Process>(
                folder.path(), std::vector<std::string>{"render", "scene.xml", "-q", "-o", "both",
                                                        "--seed", seed});
        };
        const auto a = begin("1"), b = begin("2");
        EXPECT_EQ(a->wait(), exit_code::success);
        EXPECT_EQ(b->wait(), exit_code::success);
        const std::vector<float> both = plane("both.exr");
        EXPECT_TRUE(both == plane("first.exr") || both == plane("second.exr"));
        expect_no_leftovers();
    }
}

TEST_F(RenderCommandTest, N7_too_little_memory_is_an_error_and_no_crash) {
    render({"-q", "--checkpoint", "state.exr"});
    const std::string before = read_whole(folder / "scene.exr");
    int refused = 0;
    // What the film of this size needs is far above, what a small render needs below the limits.
    for (const rlim_t megabytes : {1000u, 1300u, 1600u}) {
        Process process(folder.path(),
                        {"render", "scene.xml", "-q", "--threads", "1", "--resolution",
                         "12000x12000", "--spp", "1"},
                        {.memory = megabytes << 20});
        EXPECT_EQ(process.wait(), exit_code::failure) << process.errors();
        refused += process.errors().find("memory") != std::string::npos;
    }
    EXPECT_EQ(refused, 3);
    EXPECT_EQ(read_whole(folder / "scene.exr"), before);
    expect_no_leftovers();
}

TEST_F(RenderCommandTest, N3_failing_checkpoints_do_not_end_the_render) {
    render({"-q", "--checkpoint", "state.exr"});
    const rlim_t picture = fs::file_size(folder / "scene.exr");
    const rlim_t state = fs::file_size(folder / "state.exr");
    ASSERT_LT(picture, state);
    // At the end it is an error, since the file is older than the pictures.
    render({"--time", "1", "-o", "new", "--checkpoint", "state.exr", "--checkpoint-every", "0.1"},
           exit_code::file, {.largest_file = (picture + state) / 2});
    EXPECT_EQ(plane("new.exr").size(), 32u * 24u);
    expect_error("warning: no checkpoint");
    EXPECT_EQ(fs::file_size(folder / "state.exr"), state);
}

}  // namespace
}  // namespace lucerna
