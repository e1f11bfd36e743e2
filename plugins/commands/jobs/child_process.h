// SPDX-License-Identifier: Apache-2.0
/// Programs that are run by this one, without a shell.
#pragma once

#include <sys/types.h>

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
pid_t start_child(const ChildSettings& settings, int output);

/// The exit code that a shell would tell: 128 + the signal that ended the process.
int exit_code_of(int status);

struct ChildOutput {
    int code = 0;
    std::string text;  ///< what it wrote, errors included
};

/// Runs a program to its end.
ChildOutput run_child(const ChildSettings& settings);

}  // namespace lucerna
