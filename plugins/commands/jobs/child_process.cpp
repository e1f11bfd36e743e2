// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/child_process.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

namespace lucerna {

pid_t start_child(const ChildSettings& settings, int output) {
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

int exit_code_of(int status) {
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

ChildOutput run_child(const ChildSettings& settings) {
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
