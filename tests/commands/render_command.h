// SPDX-License-Identifier: Apache-2.0
/// `lucerna render` in a folder of its own, and what it leaves there.
#pragma once

#include "core/image/exr.h"
#include "core/interfaces/command.h"
#include "tests/commands/process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>

namespace lucerna {

class RenderCommandTest : public testing::Test {
protected:
    RenderCommandTest() { write("scene.xml", small_scene); }

    void write(const char* name, const std::string& text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
    }
    /// Runs `lucerna render scene.xml WORDS`, checks the exit code, returns what it printed.
    std::string render(std::vector<std::string> words, int expected = exit_code::success,
                       const ProcessSetup& setup = {}) {
        words.insert(words.begin(), {"render", "scene.xml"});
        Process process(folder.path(), words, setup);
        EXPECT_EQ(process.wait(), expected) << process.errors();
        errors = process.errors();
        return process.output();
    }
    std::vector<float> plane(const char* file, const char* name = "R") const {
        return std::get<std::vector<float>>(read_exr(folder / file).plane(name)->samples);
    }
    void expect_error(const std::string& words) const {
        EXPECT_NE(errors.find(words), std::string::npos) << errors;
    }
    /// Nothing but what is named lies in the folder: no temporary file is left.
    void expect_no_leftovers() const {
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            const std::string extension = entry.path().extension();
            EXPECT_TRUE(extension == ".exr" || extension == ".png" || extension == ".txt" ||
                        extension == ".xml")
                << entry.path();
        }
    }
    /// Starts a render that would take for ever and waits until its first checkpoint is there.
    std::unique_ptr<Process> start_endless(const std::vector<std::string>& options = {}) const {
        std::vector<std::string> words = {
            "render",       "scene.xml", "--resolution",       "200x200", "--spp", "10000000",
            "--checkpoint", "state.exr", "--checkpoint-every", "0.01"};
        words.insert(words.end(), options.begin(), options.end());
        auto process = std::make_unique<Process>(folder.path(), words);
        for (int i = 0; i < 1000 && !std::filesystem::exists(folder / "state.exr"); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        return process;
    }

    TemporaryFolder folder;
    std::string errors;
};

}  // namespace lucerna
