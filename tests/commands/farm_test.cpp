// SPDX-License-Identifier: Apache-2.0
/// `lucerna farm` without Slurm: a packed scene needs nothing but its folder, and its parts make
/// the bits of one render. slurm.sh beside this file runs it with Slurm.
#include "core/image/exr.h"
#include "core/interfaces/command.h"
#include "tests/commands/process.h"
#include "tests/vol_writer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/stat.h>

#include <chrono>
#include <thread>

namespace lucerna {
namespace {

namespace fs = std::filesystem;

const char* const triangle = "v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

class Farm : public testing::Test {
protected:
    /// A scene with all ways of naming files: include, search path, parameter, absolute name.
    Farm() {
        fs::create_directories(folder / "source/sub");
        fs::create_directories(folder / "models");
        write("models/a.obj", triangle);
        write("models/b & c.obj", triangle);
        write("models/d.obj", "v -1 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
        write("models/grey.spd", "400 0.5\n700 0.5\n");
        write("source/scene.xml", R"(<scene version="3.0.0">
            <default name="spp" value="8"/>
            <path value="../models"/>
            <integrator type="path"/>
            <sensor type="perspective">
                <transform name="to_world">
                    <lookat origin="0, 1, 4" target="0, 0.5, 0" up="0, 1, 0"/>
                </transform>
                <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
                <film type="hdrfilm">
                    <integer name="width" value="32"/><integer name="height" value="24"/>
                    <string name="component_format" value="float32"/>
                </film>
            </sensor>
            <include filename="sub/meshes.xml"/>
            <emitter type="constant"/>
        </scene>)");
        write("source/sub/meshes.xml",
              R"(<scene><shape type="obj"><string name="filename" value="${model}.obj"/></shape>
              <shape type="obj" id="other"><string name="filename" value=")" +
                  (folder / "models").string() + R"(/b &amp; c.obj"/><bsdf type="diffuse">
              <spectrum name="reflectance" filename='grey.spd'/></bsdf></shape></scene>)");
    }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder / name) << text;
    }
    int run(std::vector<std::string> words) {
        Process process(folder.path(), words);
        const int code = process.wait();
        output = process.output();
        errors = process.errors();
        return code;
    }
    int pack(int parts, const std::vector<std::string>& more = {}) {
        std::vector<std::string> words = {
            "farm", "source/scene.xml", "--parts", std::to_string(parts), "-o", "job",
            "-D",   "model=a"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
    std::set<std::string> names(const std::string& in) const {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder / in)) {
            names.insert(entry.path().filename().string());
        }
        return names;
    }
    nlohmann::json status() {
        run({"farm", "job", "--status", "--json"});
        return nlohmann::json::parse(output);
    }

    TemporaryFolder folder;
    std::string output, errors;
};

TEST_F(Farm, APackedSceneNeedsNothingButItsFolder) {
    ASSERT_EQ(run({"render", "source/scene.xml", "-D", "model=a", "-D", "spp=16", "--set",
                   "other.filename=d.obj", "-o", "single"}),
              exit_code::success)
        << errors;
    ASSERT_EQ(pack(5, {"-D", "spp=16", "--set", "other.filename=d.obj"}), exit_code::success)
        << errors;
    fs::rename(folder / "source", folder / "gone");
    fs::rename(folder / "models", folder / "gone too");
    ASSERT_EQ(run({"farm", "job", "--local", "2"}), exit_code::success) << errors;
    EXPECT_EQ(read_whole(folder / "job/scene.png"), read_whole(folder / "single.png"));
    ASSERT_EQ(run({"diff", "job/scene.exr", "single.exr", "--json"}), exit_code::success);
    EXPECT_EQ(nlohmann::json::parse(output).at("all_pixels").at("mse"), 0) << output;
}

TEST_F(Farm, EqualFilesArePackedOnce) {
    ASSERT_EQ(pack(2), exit_code::success) << errors;
    EXPECT_EQ(names("job/scene"),
              (std::set<std::string>{"a.obj", "grey.spd", "meshes.xml", "scene.xml"}));
}

/// A plugin of somebody else, a picture as a texture, the same one as a light, and a volume.
TEST_F(Farm, PluginsPicturesAndVolumesArePacked) {
    const fs::path plugins = folder / "their plugins";
    fs::create_directories(plugins / "shapes");
    fs::copy(program_path().parent_path().parent_path() / "tests/faulty/shapes/wrong_area.so",
             plugins / "shapes");
    ImageFile picture;
    picture.width = picture.full_width = 4;
    picture.height = picture.full_height = 2;
    for (const char* name : {"R", "G", "B"}) {
        picture.planes.push_back({.name = name, .samples = std::vector<float>(8, 0.5f)});
    }
    write_exr(folder / "source/grey.exr", picture);
    fs::copy(folder / "source/grey.exr", folder / "source/same.exr");
    write_bytes(folder / "source/smoke.vol",
                vol_bytes({.resolution = {2, 2, 2}}, std::vector<float>(8, 1.0f)));
    write("source/scene.xml", R"(<scene version="3.0.0">
        <integrator type="volpath"/>
        <sensor type="perspective">
            <film type="hdrfilm"><integer name="width" value="16"/>
            <integer name="height" value="16"/></film>
        </sensor>
        <shape type="wrong_area"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
        <string name="filename" value="grey.exr"/></texture></bsdf></shape>
        <shape type="cube"><bsdf type="null"/><medium type="heterogeneous" name="interior">
        <volume type="gridvolume" name="sigma_t"><string name="filename" value="smoke.vol"/>
        </volume></medium></shape>
        <emitter type="envmap"><string name="filename" value="same.exr"/></emitter></scene>)");
    const std::vector<std::string> scene = {"source/scene.xml", "--spp", "8", "--plugins",
                                            plugins.string()};
    std::vector<std::string> render = {"render", "-o", "single"};
    std::vector<std::string> farm = {"farm", "-o", "job", "--parts", "4"};
    for (auto* const words : {&render, &farm}) {
        words->insert(words->end(), scene.begin(), scene.end());
        ASSERT_EQ(run(*words), exit_code::success) << errors;
    }
    EXPECT_EQ(names("job/scene"), (std::set<std::string>{"grey.exr", "scene.xml", "smoke.vol"}));
    EXPECT_TRUE(fs::exists(folder / "job/plugins/shapes/wrong_area.so"));
    fs::rename(folder / "source", folder / "gone");
    fs::rename(plugins, folder / "gone too");
    ASSERT_EQ(run({"farm", "job", "--local", "2"}), exit_code::success) << errors;
    EXPECT_EQ(read_whole(folder / "job/scene.png"), read_whole(folder / "single.png"));
}

TEST_F(Farm, AnInterruptedRunGoesOnToTheSameBits) {
    ASSERT_EQ(run({"render", "source/scene.xml", "-D", "model=a", "--spp", "4000", "-o", "single"}),
              exit_code::success);
    ASSERT_EQ(pack(6, {"--spp", "4000"}), exit_code::success) << errors;
    int stops = 0;
    for (int wait = 300; wait < 2000; wait += 100) {
        Process process(folder.path(), {"farm", "job", "--local", "2"});
        std::this_thread::sleep_for(std::chrono::milliseconds(wait));
        process.kill(SIGTERM);
        const int code = process.wait();
        if (code == exit_code::success) break;
        if (code == 128 + SIGTERM) continue;  // it had not even begun
        ASSERT_EQ(code, exit_code::interrupted) << process.errors();
        ++stops;
    }
    ASSERT_GT(stops, 0) << "the parts are too short to be interrupted";
    ASSERT_EQ(run({"farm", "job", "--local", "2"}), exit_code::success) << errors;
    EXPECT_EQ(read_whole(folder / "job/scene.png"), read_whole(folder / "single.png"));
}

TEST_F(Farm, StatusTellsOfFailedParts) {
    ASSERT_EQ(pack(3), exit_code::success) << errors;
    EXPECT_EQ(status().at("waiting"), 3);
    fs::remove(folder / "job/scene/a.obj");
    EXPECT_EQ(run({"farm", "job", "--local", "1"}), exit_code::failure);
    EXPECT_EQ(errors,
              "part 1 failed with exit code 3; see job/logs/1.txt\n"
              "part 2 failed with exit code 3; see job/logs/2.txt\n"
              "part 3 failed with exit code 3; see job/logs/3.txt\n");
    EXPECT_EQ(status().at("failed"), 3);
    write("job/scene/a.obj", triangle);
    EXPECT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::success) << errors;
    EXPECT_EQ(run({"farm", "job", "--status"}), exit_code::success);
    EXPECT_EQ(output, "scene: 3 of 3 parts done, 0 running, 0 waiting\nmerged\n");
}

TEST_F(Farm, StatusTellsOfTheMerge) {
    ASSERT_EQ(pack(2), exit_code::success) << errors;
    EXPECT_EQ(status().at("merge"), "waiting");
    ASSERT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::success) << errors;
    EXPECT_EQ(status().at("merge"), "done");
    write("job/parts/2.exr", "nothing of a state");
    EXPECT_EQ(run({"farm", "job", "--local", "1", "-q"}), exit_code::file);
    EXPECT_EQ(run({"farm", "job", "--status"}), exit_code::failure);
    EXPECT_NE(output.find("the merge failed on "), std::string::npos) << output;
    EXPECT_NE(output.find(" with exit code 5; see job/logs/merge.txt\n"), std::string::npos);
    // Started before Slurm's queue forgot it, and not ended.
    write("job/records/merge.txt", "start 1767225600 node7\n");
    EXPECT_EQ(status().at("merge"), "running");
    write("job/slurm_jobs.txt", "71 72\n");
    EXPECT_EQ(status().at("merge"), "lost");
}

TEST_F(Farm, StatusEstimatesTheTimeLeft) {
    ASSERT_EQ(pack(4), exit_code::success) << errors;
    const std::int64_t now = std::time(nullptr);
    for (const int part : {1, 2}) {
        write(fmt::format("job/parts/{}.exr", part), "");
        write(fmt::format("job/records/{}.txt", part),
              fmt::format("start {} a\nend {} 0\n", now - 3000, now - 2000));
    }
    // A part that was stopped after 300 s, and runs for 200 s now: 500 s of 1000 are left, and the
    // 1000 s of part 4.
    write("job/records/3.txt",
          fmt::format("start {} a\nend {} 130\nstart {} b\n", now - 1000, now - 700, now - 200));
    const nlohmann::json json = status();
    EXPECT_EQ(json.at("done"), 2);
    EXPECT_EQ(json.at("running"), 1);
    EXPECT_NEAR(json.at("seconds_left").get<double>(), 1500, 5);
}

TEST_F(Farm, SubmitsWhatIsMissingAndTheMergeAfterIt) {
    fs::create_directories(folder / "bin");
    write("bin/sbatch", "#!/bin/sh\necho \"$@\" >> said.txt\necho 71\n");
    write("bin/squeue", "#!/bin/sh\nexit 1\n");
    for (const char* name : {"bin/sbatch", "bin/squeue"}) chmod((folder / name).c_str(), 0755);
    ASSERT_EQ(pack(6, {"--slurm=--partition=long"}), exit_code::success) << errors;
    for (const char* part : {"2", "5"}) write(fmt::format("job/parts/{}.exr", part), "");
    ProcessSetup setup;
    setup.environment = fmt::format("PATH={}:/usr/bin:/bin", (folder / "bin").string());
    Process process(folder.path(), {"farm", "job", "--submit"}, setup);
    ASSERT_EQ(process.wait(), exit_code::success) << process.errors();
    EXPECT_EQ(read_whole(folder / "job/said.txt"),
              "--parsable --array=1,3-4,6 part.sh\n"
              "--parsable --dependency=afterok:71 merge.sh\n");
    EXPECT_NE(read_whole(folder / "job/part.sh").find("#SBATCH --partition=long\n"),
              std::string::npos);
}

/// A part and the merge, whose program ends with an exit code, in a Slurm that only writes down
/// what it is asked for. In Slurm, the last part of an array has the number of the array itself.
TEST_F(Farm, PartsRequeueThemselvesAndNoOthers) {
    ASSERT_EQ(pack(2), exit_code::success) << errors;
    fs::create_directories(folder / "bin");
    write("bin/scontrol", "#!/bin/sh\necho \"$@\" >> said.txt\n");
    write("bin/program", "#!/bin/sh\nexit $CODE\n");
    for (const char* name : {"bin/scontrol", "bin/program"}) {
        chmod((folder / name).c_str(), 0755);
    }
    const auto said = [&](const std::string& script, int code, const std::string& more = "") {
        fs::remove(folder / "job/said.txt");
        const std::string command = fmt::format(
            "cd {} && PATH={}:$PATH LUCERNA={} CODE={} SLURM_JOB_ID=71 {} bash {} > /dev/null",
            (folder / "job").string(), (folder / "bin").string(), (folder / "bin/program").string(),
            code, more, script);
        EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), code);
        return read_whole(folder / "job/said.txt");
    };
    const std::string last = "SLURM_ARRAY_JOB_ID=71 SLURM_ARRAY_TASK_ID=2";
    EXPECT_EQ(said("part.sh", 75, last), "requeue 71_2\n");
    EXPECT_EQ(said("part.sh", 137, last), "requeue 71_2\n");
    EXPECT_EQ(said("part.sh", 75, last + " SLURM_RESTART_COUNT=20"), "");
    EXPECT_EQ(said("merge.sh", 75), "requeue 71\n");
    EXPECT_EQ(said("merge.sh", 137), "requeue 71\n");
    EXPECT_EQ(said("merge.sh", 75, "SLURM_RESTART_COUNT=20"), "");
    for (const int code : {0, 1, 3, 5}) {
        EXPECT_EQ(said("part.sh", code, last), "");
        EXPECT_EQ(said("merge.sh", code), "");
    }
}

TEST_F(Farm, WrongArgumentsAreExplained) {
    const auto refuses = [&](const std::vector<std::string>& words, const std::string& message) {
        EXPECT_EQ(run(words), exit_code::usage);
        EXPECT_EQ(errors, "lucerna farm: " + message + "\n");
    };
    const std::string scene = "source/scene.xml";
    refuses({"farm", scene, "-o", "job"},
            "--parts N is missing: of how many parts the job is made");
    refuses({"farm", scene, "--parts", "2"}, "-o DIR is missing: the folder of the job");
    refuses({"farm", scene, "--status"}, "--status needs the folder of a job instead of a scene");
    refuses({"farm", scene, "--submit", "--local", "2"},
            "give only one of --submit, --local and --status");
    refuses(
        {"farm", "models", "--status"},
        "models is no folder of a job: there is no job.txt in it; `lucerna farm SCENE --parts N "
        "-o models` makes one");
    refuses({"farm", scene, "--parts", "2", "-o", "job", "--slurm", "long"},
            "--slurm \"long\" is no option of sbatch: expected --NAME=VALUE");
    ASSERT_EQ(pack(2), exit_code::success) << errors;
    refuses({"farm", scene, "--parts", "2", "-o", "job"},
            "job is the folder of a job already; give another one, or remove it");
    refuses({"farm", "job"}, "what is to be done with job? Give --submit, --local N or --status");
    refuses({"farm", "job", "--parts", "3", "--submit"},
            "job is packed already: only --submit, --local, --status, --quiet and --json go with "
            "it; change its scripts, or pack the scene anew");
}

TEST_F(Farm, WhatCannotBePackedIsExplained) {
    EXPECT_EQ(pack(9), exit_code::failure);
    EXPECT_EQ(errors,
              "8 samples per pixel cannot be divided into 9 parts; give more --spp or fewer "
              "--parts\n");
    EXPECT_FALSE(fs::exists(folder / "job"));
}

}  // namespace
}  // namespace lucerna
