// SPDX-License-Identifier: Apache-2.0
/// Renders in parts: `lucerna render --part` and `lucerna merge`, killed and started again.
#include "core/interfaces/light_sampler.h"
#include "core/math/sequences.h"
#include "core/plugin/registry.h"
#include "core/render/state_file.h"
#include "tests/commands/render_command.h"
#include "tests/core/render/films.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <map>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

class PartsTest : public RenderCommandTest {
protected:
    PartsTest() { fs::create_directory(folder / "parts"); }

    std::string file_of(int part) const { return "parts/" + std::to_string(part) + ".exr"; }

    void render_part(int part, int count, std::vector<std::string> words,
                     int expected = exit_code::success) {
        const std::vector<std::string> own = {"-q", "-o", file_of(part), "--part",
                                              std::to_string(part) + "/" + std::to_string(count)};
        words.insert(words.end(), own.begin(), own.end());
        render(words, expected);
    }
    /// Runs `lucerna merge WORDS`.
    std::string merge(std::vector<std::string> words, int expected = exit_code::success,
                      const ProcessSetup& setup = {}) {
        words.insert(words.begin(), "merge");
        Process process(folder.path(), words, setup);
        EXPECT_EQ(process.wait(), expected) << process.errors();
        errors = process.errors();
        return process.output();
    }
    void expect_same_pictures(const char* a, const char* b) const {
        const ImageFile x = read_exr(folder / (a + std::string(".exr")));
        const ImageFile y = read_exr(folder / (b + std::string(".exr")));
        ASSERT_EQ(x.planes.size(), y.planes.size());
        for (std::size_t i = 0; i < x.planes.size(); ++i) {
            EXPECT_EQ(x.planes[i].name, y.planes[i].name);
            EXPECT_EQ(x.planes[i].half, y.planes[i].half);
            EXPECT_EQ(x.planes[i].samples, y.planes[i].samples) << x.planes[i].name;
        }
        EXPECT_EQ(read_whole(folder / (a + std::string(".png"))),
                  read_whole(folder / (b + std::string(".png"))));
    }
};

/// A room with 24 lights, a ball of glass that casts caustics, and a ball of fog.
std::string room() {
    std::string lamps;
    for (int i = 0; i < 12; ++i) {
        lamps += fmt::format(
            R"(<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/>
            <scale value="0.1"/><translate value="{}, 1.9, {}"/></transform>
            <emitter type="area"><rgb name="radiance" value="{}, 4, 3"/></emitter></shape>
            <emitter type="point"><point name="position" value="{}, 1.5, {}"/>
            <float name="intensity" value="0.1"/></emitter>)",
            0.3 * (i % 4) - 0.5, 0.4 * (i / 4) - 0.5, i + 1, 0.2 * (i % 6) - 0.5, 0.3 * (i / 6));
    }
    return R"(<scene version="3.0.0">
        <integrator type="path"/>
        <sensor type="perspective">
            <transform name="to_world">
                <lookat origin="0, 1, 4" target="0, 0.5, 0" up="0, 1, 0"/>
            </transform>
            <film type="hdrfilm">
                <integer name="width" value="32"/><integer name="height" value="24"/>
                <string name="component_format" value="float32"/>
            </film>
        </sensor>
        <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/>
        <scale value="2"/></transform></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="2"/>
        <translate value="0, 1, -1"/></transform></shape>
        <shape type="sphere"><point name="center" value="-0.5, 0.4, 0.5"/>
        <float name="radius" value="0.4"/><bsdf type="dielectric"/></shape>
        <shape type="sphere"><point name="center" value="0.6, 0.5, 0.5"/>
        <float name="radius" value="0.4"/><bsdf type="null"/>
        <medium type="homogeneous" name="interior"><float name="sigma_t" value="3"/></medium>
        </shape>)" +
           lamps + "</scene>";
}

class PartsOfRoom : public PartsTest, public testing::WithParamInterface<std::string> {
protected:
    /// Four parts on one to four threads have the bits of one render.
    void expect_whole(const std::vector<std::string>& scene) {
        write("scene.xml", room());
        fs::remove_all(folder / "parts");
        fs::create_directory(folder / "parts");
        std::vector<std::string> whole = scene;
        whole.insert(whole.end(), {"-q", "-o", "whole"});
        render(whole);
        for (const int part : {3, 1, 4, 2}) {
            std::vector<std::string> words = scene;
            words.insert(words.end(), {"--threads", std::to_string(part)});
            render_part(part, 4, words);
        }
        merge({"parts/4.exr", "parts/1.exr", "parts/3.exr", "parts/2.exr", "-q", "-o", "merged"});
        EXPECT_EQ(errors, "");
        expect_same_pictures("whole", "merged");
    }
};

class PartsOfIntegrators : public PartsOfRoom {};

TEST_P(PartsOfIntegrators, AreTheWholeRender) {
    std::vector<std::string> scene = {"--set", "integrator=" + GetParam(), "--spp", "13", "--seed",
                                      "5"};
    const std::map<std::string, std::vector<std::string>> photons = {
        {"sppm", {"photon_count"}},
        {"photonmap", {"global_photons", "caustic_photons", "volume_photons"}}};
    if (const auto counts = photons.find(GetParam()); counts != photons.end()) {
        for (const std::string& count : counts->second) {
            scene.insert(scene.end(), {"--set", fmt::format("integrator.{}=10000", count)});
        }
    }
    expect_whole(scene);
}

class PartsWithLightSamplers : public PartsOfRoom {};

TEST_P(PartsWithLightSamplers, AreTheWholeRender) {
    expect_whole({"--set", "integrator.light_sampler=" + GetParam(), "--spp", "9"});
    expect_whole({"--set", "integrator=volpath", "--set", "integrator.light_sampler=" + GetParam(),
                  "--spp", "5"});
}

/// All that there are, but for those that need other integrators as children.
std::vector<std::string> integrators() {
    std::vector<std::string> names = Registry().names(Integrator::kind);
    std::erase(names, "moment");
    return names;
}

INSTANTIATE_TEST_SUITE_P(Integrators, PartsOfIntegrators, testing::ValuesIn(integrators()));
INSTANTIATE_TEST_SUITE_P(LightSamplers, PartsWithLightSamplers,
                         testing::ValuesIn(Registry().names(LightSampler::kind)));

TEST_F(PartsTest, FiltersAndFormatsDoNotMatter) {
    for (const char* change :
         {"integrator.reuse=1", "sensor.film.rfilter=lanczos", "sensor.film.rfilter=box",
          "sensor.sampler=sobol", "sensor.film.pixel_format=rgba", "sensor.film.file_format=png"}) {
        fs::remove_all(folder / "parts");
        fs::create_directory(folder / "parts");
        render({"-q", "-o", "whole", "--spp", "8", "--set", change});
        for (const int part : {1, 2, 3}) render_part(part, 3, {"--spp", "8", "--set", change});
        merge({"parts/1.exr", "parts/2.exr", "parts/3.exr", "-q", "-o", "merged"});
        expect_same_pictures("whole", "merged");
    }
}

TEST_F(PartsTest, CropsAreMerged) {
    const std::vector<std::string> crop = {"--spp", "6", "--crop", "5,7,10,8"};
    render({"-q", "-o", "whole", "--spp", "6", "--crop", "5,7,10,8"});
    for (const int part : {1, 2}) render_part(part, 2, crop);
    merge({"parts/1.exr", "parts/2.exr", "-q", "-o", "merged"});
    expect_same_pictures("whole", "merged");
}

TEST_F(PartsTest, ATreeOfMergesHasTheSameBits) {
    render({"-q", "-o", "whole", "--spp", "40", "--checkpoint", "whole_state.exr"});
    for (int part = 1; part <= 5; ++part) render_part(part, 5, {"--spp", "40"});
    merge({"parts/5.exr", "parts/2.exr", "-q", "--partial", "--state", "a.exr"});
    merge({"parts/3.exr", "parts/1.exr", "-q", "--partial", "--state", "b.exr"});
    merge({"a.exr", "parts/4.exr", "b.exr", "-q", "-o", "merged", "--state", "all.exr"});
    expect_same_pictures("whole", "merged");
    const RenderState all = read_state(folder / "all.exr");
    EXPECT_TRUE(same_bits(all.film, read_state(folder / "whole_state.exr").film));
    EXPECT_EQ(all.part.parts, 5);
    EXPECT_EQ(all.part.samples.text(), "0-39");
}

TEST_F(PartsTest, TheMergedStateCanBeRefined) {
    render({"-q", "-o", "whole", "--spp", "32"});
    for (const int part : {1, 2}) render_part(part, 2, {"--spp", "16"});
    merge({"parts/1.exr", "parts/2.exr", "-q", "--state", "all.exr"});
    render({"-q", "-o", "refined", "--spp", "32", "--checkpoint", "all.exr", "--resume"});
    expect_same_pictures("whole", "refined");
    merge({"parts/2.exr", "-q", "--partial", "--state", "half.exr"});
    render({"-q", "-o", "refined", "--spp", "32", "--checkpoint", "half.exr", "--resume"},
           exit_code::failure);
    EXPECT_EQ(
        errors,
        "cannot resume from half.exr: it is a part of a render, with samples 8-15 only; merge "
        "all parts with `lucerna merge --state`\n");
}

TEST_F(PartsTest, CheckpointsCanBeMergedWithParts) {
    render({"-q", "-o", "whole", "--spp", "16", "--set", "sensor.film.pixel_format=luminance"});
    render({"-q", "-o", "first", "--spp", "8", "--checkpoint", "first_state.exr", "--set",
            "sensor.film.pixel_format=luminance"});
    render_part(2, 2, {"--spp", "16", "--set", "sensor.film.pixel_format=luminance"});
    merge({"parts/2.exr", "first_state.exr", "-q", "-o", "merged"});
    expect_same_pictures("whole", "merged");
    merge({"first_state.exr", "-q", "-o", "merged"});
    expect_same_pictures("first", "merged");
    EXPECT_FALSE(read_exr(folder / "merged.exr").metadata.contains("lucerna:wall_seconds"));
}

TEST_F(PartsTest, MetadataTellWhatItTook) {
    for (const int part : {1, 2}) render_part(part, 2, {"--spp", "8"});
    merge({"parts/1.exr", "parts/2.exr", "-q", "-o", "merged"});
    const Metadata metadata = read_exr(folder / "merged.exr").metadata;
    const RenderState one = read_state(folder / "parts/1.exr");
    const RenderState two = read_state(folder / "parts/2.exr");
    EXPECT_EQ(std::get<double>(metadata.at("lucerna:render_seconds")), one.seconds + two.seconds);
    EXPECT_EQ(std::get<double>(metadata.at("lucerna:wall_seconds")), two.part.end - one.part.begin);
    EXPECT_GT(two.part.begin, one.part.end);
    EXPECT_EQ(std::get<int>(metadata.at("lucerna:parts")), 2);
    EXPECT_EQ(std::get<std::string>(metadata.at("lucerna:samples_per_pixel")), "8");
}

TEST_F(PartsTest, RunAgainNothingIsLeftToRender) {
    render_part(2, 3, {"--spp", "12"});
    const std::string before = read_whole(folder / "parts/2.exr");
    render({"--spp", "12", "--part", "2/3", "-o", "parts/2.exr"});
    EXPECT_EQ(errors, "parts/2.exr is there already: nothing is left to render\n");
    EXPECT_EQ(read_whole(folder / "parts/2.exr"), before);
    EXPECT_FALSE(fs::exists(folder / "parts/2.exr.checkpoint"));
}

TEST_F(PartsTest, TwoTasksThatRenderOnePartLeaveIt) {
    render({"-q", "-o", "whole", "--spp", "64"});
    const auto begin = [&] {
        return std::make_unique<Process>(
            folder.path(),
            std::vector<std::string>{"render", "scene.xml", "-q", "--spp", "64", "--part", "1/1",
                                     "-o", "parts/1.exr", "--checkpoint-every", "0.001"});
    };
    for (int i = 0; i < 4; ++i) {
        fs::remove(folder / "parts/1.exr");
        const auto a = begin(), b = begin();
        EXPECT_EQ(a->wait(), exit_code::success) << a->errors();
        EXPECT_EQ(b->wait(), exit_code::success) << b->errors();
        merge({"parts/1.exr", "-q", "-o", "merged"});
        expect_same_pictures("whole", "merged");
    }
}

TEST_F(PartsTest, TwoTasksThatRenderOnePartWriteTheSameFile) {
    render_part(1, 2, {"--spp", "64", "--threads", "1"});
    const std::string first = read_whole(folder / "parts/1.exr");
    fs::remove(folder / "parts/1.exr");
    render_part(1, 2, {"--spp", "64", "--threads", "3"});
    const std::string second = read_whole(folder / "parts/1.exr");
    ASSERT_EQ(first.size(), second.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < first.size(); ++i) different += first[i] != second[i];
    // Three times of eight bytes, and the checksum that covers them.
    EXPECT_LE(different, 4 * sizeof(double));
}

TEST_F(PartsTest, MergingNeedsTheMemoryOfOneFilm) {
    const std::vector<std::string> large = {"--spp", "24", "--resolution", "400x300"};
    std::vector<std::string> few = {"-q", "--json", "--partial", "-o", "few"}, all = few;
    all.back() = "all";
    for (int part = 1; part <= 24; ++part) {
        render_part(part, 24, large);
        all.push_back(file_of(part));
        if (part <= 2) few.push_back(file_of(part));
    }
    const auto peak = [&](const std::vector<std::string>& words) {
        return nlohmann::json::parse(merge(words))
            .at("figures")
            .at("peak_memory_bytes")
            .get<double>();
    };
    const double of_two = peak(few), file = double(fs::file_size(folder / "parts/1.exr"));
    EXPECT_LT(peak(all), of_two + 3 * file);
    EXPECT_LT(peak(all), of_two * 1.25);
}

TEST_F(PartsTest, ATimeLimitIsToldAndCanBeRaised) {
    const std::vector<std::string> much = {"--spp", "1000000"};
    const auto with_time = [&](const char* seconds) {
        std::vector<std::string> words = much;
        words.insert(words.end(), {"--time", seconds});
        return words;
    };
    render_part(1, 2, with_time("0.2"));
    render_part(2, 2, with_time("0.2"));
    const RenderState first = read_state(folder / "parts/1.exr");
    EXPECT_EQ(first.part.samples.ranges()[0].begin, 0u);
    EXPECT_EQ(first.part.planned.text(), "0-499999");
    EXPECT_LT(first.film.complete_samples(), 500000u);
    merge({"parts/1.exr", "parts/2.exr", "-q", "-o", "merged"});
    expect_error("samples per pixel are left out, since the --time of their parts was over: ");
    // Again: nothing. Longer: goes on.
    const std::string before = read_whole(folder / "parts/1.exr");
    render_part(1, 2, with_time("0.2"));
    EXPECT_EQ(read_whole(folder / "parts/1.exr"), before);
    render_part(1, 2, with_time("0.4"));
    const RenderState longer = read_state(folder / "parts/1.exr");
    EXPECT_GT(longer.film.complete_samples(), first.film.complete_samples());
}

TEST_F(PartsTest, KilledAtRandomNothingIsLost) {
    render({"-q", "-o", "whole", "--resolution", "64x48", "--spp", "1200"});
    Rng rng(17);
    int killed = 0, requeued = 0;
    unsigned longest = 100;  // [ms]; grows, for machines that need as much to begin
    int signal = SIGTERM;
    for (int part = 1; part <= 3; ++part) {
        for (bool done = false; !done;) {
            Process process(folder.path(), {"render", "scene.xml", "-q", "--resolution", "64x48",
                                            "--spp", "1200", "--part", std::to_string(part) + "/3",
                                            "-o", file_of(part), "--checkpoint-every", "0.02"});
            std::this_thread::sleep_for(std::chrono::milliseconds(30 + rng.next_uint() % longest));
            longest += 10;
            signal = signal == SIGTERM ? SIGKILL : SIGTERM;
            process.kill(signal);
            const int code = process.wait();
            const bool again = code == exit_code::interrupted || code == 128 + signal;
            done = code == exit_code::success;
            EXPECT_TRUE(done || again) << code << process.errors();
            killed += code == 128 + SIGKILL;
            requeued += code == exit_code::interrupted;
            ASSERT_LT(killed + requeued, 500);
        }
    }
    EXPECT_GT(killed, 1);
    EXPECT_GT(requeued, 1);
    merge({"parts/1.exr", "parts/2.exr", "parts/3.exr", "-q", "-o", "merged"});
    expect_same_pictures("whole", "merged");
}

TEST_F(PartsTest, DamagedFilesAreRenderedAgain) {
    render({"-q", "-o", "whole", "--spp", "8"});
    render_part(1, 1, {"--spp", "8"});
    const std::string whole = read_whole(folder / "parts/1.exr");
    write("parts/1.exr", whole.substr(0, whole.size() / 2));
    merge({"parts/1.exr", "-q", "-o", "merged"}, exit_code::file);
    expect_error("parts/1.exr");
    EXPECT_FALSE(fs::exists(folder / "merged.exr"));
    write("parts/1.exr.checkpoint", "nonsense");
    render_part(1, 1, {"--spp", "8"});
    expect_error("warning: parts/1.exr");
    expect_error("warning: parts/1.exr.checkpoint");
    merge({"parts/1.exr", "-q", "-o", "merged"});
    expect_same_pictures("whole", "merged");
}

TEST_F(PartsTest, PartsOutOfRangeAreRefused) {
    const auto refusal = [&](const char* part, std::vector<std::string> more = {"-o", "p.exr"}) {
        std::vector<std::string> words = {"--spp", "8", "--part", part};
        words.insert(words.end(), more.begin(), more.end());
        render(words, exit_code::usage);
        return errors;
    };
    EXPECT_EQ(refusal("0/4"), "lucerna render: --part 0/4: there are only parts 1 to 4\n");
    EXPECT_EQ(refusal("5/4"), "lucerna render: --part 5/4: there are only parts 1 to 4\n");
    EXPECT_EQ(refusal("1/0"), "lucerna render: --part 1/0: there must be one part at least\n");
    for (const std::string text : {"1-4", "/4", "3/", "3", "1/4x", "-1/4", "1/4/4", " 1/4"}) {
        EXPECT_EQ(refusal(text.c_str()),
                  "lucerna render: --part: expected K/N, such as 3/64, not \"" + text + "\"\n");
    }
    EXPECT_EQ(refusal("1/4", {}),
              "lucerna render: --part needs --output FILE, the file for the state of the part\n");
    const std::string own =
        "lucerna render: --part keeps a checkpoint of its own and goes on from it; leave out "
        "--checkpoint and --resume\n";
    EXPECT_EQ(refusal("1/4", {"-o", "p.exr", "--resume"}), own);
    EXPECT_EQ(refusal("1/4", {"-o", "p.exr", "--checkpoint", "c.exr"}), own);
    EXPECT_EQ(refusal("1/4", {"-o", "p.exr", "--error", "0.1"}),
              "lucerna render: --part cannot know the error of the whole picture; leave out "
              "--error\n");
    render({"--spp", "8", "--part", "1/9", "-o", "p.exr"}, exit_code::failure);
    EXPECT_EQ(errors,
              "8 samples per pixel cannot make 9 parts; raise --spp, or make at most 8 parts\n");
    EXPECT_FALSE(fs::exists(folder / "p.exr"));
}

TEST_F(PartsTest, PartsOfOtherRendersAreNotReplaced) {
    render_part(1, 2, {"--spp", "8"});
    const std::string before = read_whole(folder / "parts/1.exr");
    render_part(1, 2, {"--spp", "8", "--seed", "3"}, exit_code::failure);
    EXPECT_EQ(errors, "parts/1.exr is of --seed 0, not 3; remove it, or choose another --output\n");
    render_part(1, 2, {"--spp", "8", "-D", "radiance=2"}, exit_code::failure);
    EXPECT_EQ(errors,
              "parts/1.exr is of another scene, or the scene or its --set and -D values have "
              "changed; remove it, or choose another --output\n");
    render_part(1, 4, {"--spp", "8"}, exit_code::failure);
    EXPECT_EQ(errors,
              "parts/1.exr is the state of samples 0-3, not 0-1; remove it, or choose another "
              "--output\n");
    EXPECT_EQ(read_whole(folder / "parts/1.exr"), before);
}

TEST_F(PartsTest, WhatDoesNotFitTogetherIsRefused) {
    const auto part = [&](const char* name, const char* which, std::vector<std::string> words) {
        words.insert(words.end(), {"-q", "--part", which, "-o", name});
        render(words);
    };
    const std::vector<std::string> plain = {"--spp", "8"};
    part("a.exr", "1/2", plain);
    part("seed.exr", "2/2", {"--spp", "8", "--seed", "1"});
    part("size.exr", "2/2", {"--spp", "8", "--resolution", "20x10"});
    part("integrator.exr", "2/2", {"--spp", "8", "--set", "integrator=direct"});
    part("scene.exr", "2/2", {"--spp", "8", "-D", "radiance=2"});
    part("crop.exr", "2/2", {"--spp", "8", "--crop", "0,0,8,8"});
    part("overlap.exr", "1/4", {"--spp", "12"});
    write("good.exr", "good");
    write("good.png", "good");
    const auto refusal = [&](std::vector<std::string> files, int code = exit_code::failure) {
        files.insert(files.end(), {"-q", "-o", "good"});
        merge(files, code);
        return errors;
    };
    const std::string both = "a.exr and ";
    EXPECT_EQ(refusal({"a.exr", "seed.exr"}),
              "a.exr and seed.exr cannot be merged: they differ in the seed: 0 and 1\n");
    EXPECT_EQ(refusal({"a.exr", "size.exr"}),
              "a.exr and size.exr cannot be merged: they differ in size: 32 × 24 and 20 × 10\n");
    EXPECT_EQ(refusal({"a.exr", "integrator.exr"}),
              "a.exr and integrator.exr cannot be merged: they differ in the integrator: path and "
              "direct\n");
    EXPECT_EQ(refusal({"a.exr", "scene.exr"}),
              "a.exr and scene.exr cannot be merged: they are of different scenes, or the scene or "
              "its --set and -D values have changed between them\n");
    EXPECT_EQ(refusal({"a.exr", "crop.exr"}),
              "a.exr and crop.exr cannot be merged: they differ in their crop window\n");
    EXPECT_EQ(refusal({"a.exr", "overlap.exr"}),
              "a.exr and overlap.exr cannot be merged: both have samples 0 to 2; leave out one of "
              "them\n");
    EXPECT_EQ(
        refusal({"a.exr", "a.exr"}),
        "a.exr and a.exr cannot be merged: both have samples 0 to 3; leave out one of them\n");
    EXPECT_EQ(
        refusal({"a.exr"}),
        "4 of 8 samples per pixel are missing: 4-7; render the parts that have them, or merge "
        "with --partial\n");
    ImageFile old = read_exr(folder / "a.exr");
    old.metadata["lucerna:state"] = 3;
    old.metadata["lucerna:version"] = "0.0.9";
    write_exr(folder / "old.exr", old);
    EXPECT_EQ(refusal({"a.exr", "old.exr"}, exit_code::file),
              "a.exr and old.exr cannot be merged: old.exr was written by Lucerna 0.0.9 with "
              "version 3 of its states; this is Lucerna " +
                  std::string(core_version()) +
                  " with version 6, which cannot continue it; render it again\n");
    EXPECT_EQ(refusal({"old.exr", "a.exr"}, exit_code::file).substr(0, 23),
              "old.exr was written by ");
    render({"-q", "--spp", "1", "-o", "picture"});
    EXPECT_EQ(refusal({"picture.exr"}, exit_code::file),
              "picture.exr is not the state of a render; give a file that `lucerna render "
              "--checkpoint` or `--part` wrote\n");
    EXPECT_EQ(refusal({"nothing.exr"}, exit_code::file), "nothing.exr: there is no such file\n");
    EXPECT_EQ(refusal({}, exit_code::usage), "lucerna merge: name the files to be merged\n");
    EXPECT_EQ(refusal({"good.exr"}, exit_code::usage),
              "lucerna merge: the picture good.exr would replace a state; give it another name\n");
    merge({"a.exr"}, exit_code::usage);
    EXPECT_EQ(errors, "lucerna merge: name the picture with --output, or the state with --state\n");
    EXPECT_EQ(read_whole(folder / "good.exr"), "good");
    EXPECT_EQ(read_whole(folder / "good.png"), "good");
    merge({"a.exr", "-q", "-o", "half", "--partial"});
    EXPECT_EQ(errors, "warning: 4 of 8 samples per pixel are missing: 4-7\n");
}

TEST_F(PartsTest, AFullDiskIsNamedAndMayBeTriedAgain) {
    render_part(1, 1, {"--spp", "2"});
    fs::create_symlink("/dev/full", folder / "full.exr");
    merge({"parts/1.exr", "-q", "-o", "full"}, exit_code::try_again);
    EXPECT_EQ(errors,
              "full.exr: writing failed: No space left on device; free some space, or write to "
              "another disk\n");
    render({"-q", "--spp", "2", "--part", "1/1", "-o", "no/such/folder.exr"}, exit_code::file);
    expect_error("create the directory first");
}

TEST_F(PartsTest, AFileSystemThatFailsIsNamedAndMayBeTriedAgain) {
    write("room.obj", "v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::string scene = small_scene;
    scene.insert(scene.rfind("</scene>"), R"(<shape type="obj"><string name="filename"
        value="room.obj"/></shape>)");
    write("scene.xml", scene);
    const auto part = [&](const std::string& failing, int code) {
        render({"-q", "--spp", "2", "--part", "1/1", "-o", "parts/1.exr"}, code,
               {.failing = failing});
        return errors;
    };
    const auto fails = [&](const std::string& failing) {
        return part(failing, exit_code::try_again);
    };
    const std::string full = std::to_string(ENOSPC), stale = std::to_string(ESTALE);
    const std::string disk_is_full =
        " failed: No space left on device; free some space, or write to another disk\n";
    const std::string handle_is_stale = " failed: Stale file handle; try again\n";
    EXPECT_EQ(fails("write " + full + " parts/"), "parts/1.exr: writing" + disk_is_full);
    EXPECT_EQ(fails("fsync " + full + " parts/"),
              "parts/1.exr: writing it to the disk" + disk_is_full);
    EXPECT_EQ(fails("stat " + stale + " parts/1.exr"),
              "parts/1.exr: looking at it failed: Stale file handle; try again, or write to "
              "another place\n");
    EXPECT_EQ(fails("pread " + stale + " scene.xml"), "scene.xml: reading" + handle_is_stale);
    EXPECT_EQ(fails("open " + stale + " room.obj"),
              "room.obj: opening it for reading" + handle_is_stale);
    EXPECT_EQ(fails("stat " + stale + " room.obj"), "room.obj: looking at it" + handle_is_stale);
    EXPECT_TRUE(fs::is_empty(folder / "parts"));

    part("", exit_code::success);
    EXPECT_EQ(fails("pread " + stale + " 1.exr"), "parts/1.exr: reading" + handle_is_stale);
    const auto merge_fails = [&](const std::string& failing) {
        merge({"parts/1.exr", "-q", "-o", "merged"}, exit_code::try_again, {.failing = failing});
        EXPECT_FALSE(fs::exists(folder / "merged.exr"));
        return errors;
    };
    for (const char* const call : {"stat", "open", "pread"}) {
        EXPECT_EQ(merge_fails(fmt::format("{} {} parts/1.exr", call, stale)),
                  "parts/1.exr: " +
                      std::string(call == std::string("stat")   ? "looking at it"
                                  : call == std::string("open") ? "opening it for reading"
                                                                : "reading") +
                      handle_is_stale);
    }
    merge({"parts/1.exr", "-q", "-o", "merged"});
}

}  // namespace
}  // namespace lucerna
