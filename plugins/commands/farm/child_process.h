// SPDX-License-Identifier: Apache-2.0
/// Programs that are run by this one, without a shell.
#pragma once

#include "core/base/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct ChildSettings {
    std::vector<std::string> command;  ///< the program, looked for in $PATH, and its arguments
    std::filesystem::path folder;      ///< in which it is started
    std::vector<std::pair<std::string, std::string>> environment{};  ///< added to that of this one
};

/// Exit code of a process that could not become the program that was asked for.
inline constexpr int cannot_execute = 127;

/// Starts the program with its output and errors going to a file descriptor, and in a process
/// group of its own: signals of the terminal do not reach it. Returns its process id.
inline pid_t start_child(const ChildSettings& settings, int output) {
    std::vector<char*> words;
    for (const std::string& word : settings.command)
        words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    const pid_t child = fork();
    if (child < 0) {
        throw Error(fmt::format("{} cannot be started: {}", settings.command.front(),
                                std::strerror(errno)));
    }
    if (child > 0) return child;
    setpgid(0, 0);
    std::signal(SIGXFSZ, SIG_DFL);
    std::signal(SIGPIPE, SIG_DFL);
    for (const auto& [name, value] : settings.environment) {
        setenv(name.c_str(), value.c_str(), 1);
    }
    if (chdir(settings.folder.c_str()) != 0 || dup2(output, STDOUT_FILENO) < 0 ||
        dup2(output, STDERR_FILENO) < 0) {
        _exit(cannot_execute);
    }
    execvp(words[0], words.data());
    _exit(cannot_execute);
}

/// The exit code that a shell would tell: 128 + the signal that ended the process.
inline int exit_code_of(int status) {
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

struct ChildOutput {
    int code = 0;
    std::string text;  ///< what it wrote, errors included
};

/// Runs a program to its end.
inline ChildOutput run_child(const ChildSettings& settings) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        throw Error(fmt::format("there can be no pipe: {}", std::strerror(errno)));
    }
    const pid_t child = start_child(settings, ends[1]);
    close(ends[1]);
    ChildOutput output;
    char buffer[4096];
    for (;;) {
        const ssize_t count = read(ends[0], buffer, sizeof buffer);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        output.text.append(buffer, static_cast<std::size_t>(count));
    }
    close(ends[0]);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    output.code = exit_code_of(status);
    return output;
}

}  // namespace lucerna
