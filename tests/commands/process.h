// SPDX-License-Identifier: Apache-2.0
/// Runs the program as a shell does.
#pragma once

#include "tests/paths.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace lucerna {

inline std::string read_whole(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// In what it is started.
struct ProcessSetup {
    std::optional<rlim_t> largest_file = {};  ///< RLIMIT_FSIZE [bytes]
    std::optional<rlim_t> memory = {};        ///< RLIMIT_AS [bytes]
    std::string environment = {};             ///< "NAME=value"
    std::string failing = {};                 ///< which calls fail (failing_disk.cpp)
};

/// A program that has been started; its output goes to files in the folder it runs in.
class Process {
public:
    Process(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
            const ProcessSetup& setup = {})
        : folder_(folder) {
        pid_ = fork();
        if (pid_ == 0) become(arguments, setup);
    }
    ~Process() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            wait();
        }
    }
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    pid_t id() const { return pid_; }
    void kill(int signal) const { ::kill(pid_, signal); }
    /// The exit code; 128 + the signal that ended it.
    int wait() {
        int status = 0;
        waitpid(pid_, &status, 0);
        pid_ = 0;
        return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    }
    std::string output() const { return read_whole(folder_ / "stdout.txt"); }
    std::string errors() const { return read_whole(folder_ / "stderr.txt"); }

private:
    [[noreturn]] void become(const std::vector<std::string>& arguments,
                             const ProcessSetup& setup) const {
        const bool ready = chdir(folder_.c_str()) == 0 && freopen("stdout.txt", "w", stdout) &&
                           freopen("stderr.txt", "w", stderr);
        if (!ready) _exit(126);
        if (setup.largest_file) {
            const rlimit limit = {*setup.largest_file, *setup.largest_file};
            setrlimit(RLIMIT_FSIZE, &limit);
        }
        if (setup.memory) {
            const rlimit limit = {*setup.memory, *setup.memory};
            setrlimit(RLIMIT_AS, &limit);
        }
        std::string environment = setup.environment;
        if (!environment.empty()) putenv(environment.data());
        const std::string program = program_path();
        if (!setup.failing.empty()) {
            const auto disk = program_path().parent_path().parent_path() / "tests/failing_disk.so";
            setenv("LD_PRELOAD", disk.c_str(), 1);
            setenv("LUCERNA_FAILING", setup.failing.c_str(), 1);
        }
        std::vector<char*> words = {const_cast<char*>(program.c_str())};
        for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
        words.push_back(nullptr);
        execv(words[0], words.data());
        _exit(127);
    }

    std::filesystem::path folder_;
    pid_t pid_;
};

/// A small scene that takes no time, with an emitter in view and a texture of noise.
inline const char* const small_scene = R"(<scene version="3.0.0">
    <default name="spp" value="4"/>
    <default name="radiance" value="1"/>
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world">
            <lookat origin="0, 1, 4" target="0, 0.5, 0" up="0, 1, 0"/>
        </transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="32"/>
            <integer name="height" value="24"/>
            <string name="component_format" value="float32"/>
        </film>
    </sensor>
    <emitter type="constant"><float name="radiance" value="$radiance"/></emitter>
    <shape type="sphere"><float name="radius" value="1"/></shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform>
    </shape>
</scene>)";

}  // namespace lucerna
