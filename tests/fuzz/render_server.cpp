// SPDX-License-Identifier: Apache-2.0
/// Runs the program many times without starting it: all plugins are loaded once, and each run is a
/// child of this process (a "fork server"). So a run costs little, and a crash ends only itself.
///
///     render_server SECONDS
///
/// Each line of the input is a folder and the arguments of `lucerna`, between tabulators. The child
/// runs in the folder, and what it says on stderr is in the file `messages` there. The answer is a
/// line: "exit CODE", or "signal NUMBER". SIGXCPU ends what works for more than SECONDS of a
/// processor, SIGALRM what is there for six times as long.
#include "core/command_line/program.h"
#include "core/interfaces/command.h"
#include "core/plugin/registry.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

namespace lucerna {

namespace {

/// Libraries stay open, so that a registry of a child finds them in memory. But for OpenVDB: its
/// log4cplus starts threads, which no child has, and waits for them at the end.
void open_plugins() {
    Registry registry;
    for (const std::string& kind : plugin_kinds()) {
        if (kind == Command::kind) continue;
        for (const std::string& name : registry.names(kind)) {
            if (name != "openvdb") registry.find(kind, name);
        }
    }
    registry.find(Command::kind, "render");
}

std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> words(1);
    for (const char c : line) {
        if (c == '\t') {
            words.emplace_back();
        } else {
            words.back() += c;
        }
    }
    return words;
}

void redirect(int descriptor, const char* file, int flags) {
    const int opened = open(file, flags, 0644);
    if (opened < 0 || dup2(opened, descriptor) < 0) {
        std::perror(file);
        _exit(exit_code::failure);
    }
    close(opened);
}

[[noreturn]] void run_child(std::vector<std::string> words, unsigned seconds) {
    if (chdir(words.front().c_str()) != 0) {
        std::perror(words.front().c_str());
        _exit(exit_code::failure);
    }
    redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
    redirect(STDOUT_FILENO, "/dev/null", O_WRONLY);
    redirect(STDERR_FILENO, "messages", O_WRONLY | O_CREAT | O_TRUNC);
    const rlimit limit{seconds, seconds + 1};
    setrlimit(RLIMIT_CPU, &limit);
    alarm(6 * seconds);
    words.erase(words.begin());
    std::exit(run_program(std::move(words)));  // with all that a program does at its end
}

/// How the child ended.
std::string wait_for(pid_t child) {
    int status = 0;
    if (waitpid(child, &status, 0) < 0) return "lost";
    if (WIFEXITED(status)) return fmt::format("exit {}", WEXITSTATUS(status));
    return fmt::format("signal {}", WTERMSIG(status));
}

int serve(unsigned seconds) {
    open_plugins();
    std::string line;
    while (std::getline(std::cin, line)) {
        const pid_t child = fork();
        if (child == 0) run_child(split(line), seconds);
        if (child < 0) {
            std::perror("fork");
            return exit_code::failure;
        }
        fmt::print("{}\n", wait_for(child));
        std::fflush(stdout);
    }
    return exit_code::success;
}

}  // namespace

}  // namespace lucerna

int main(int argc, char** argv) {
    unsigned seconds = 0;
    const char* text = argc == 2 ? argv[1] : "";
    const char* end = text + std::strlen(text);
    if (std::from_chars(text, end, seconds).ptr != end || seconds == 0) {
        std::fputs("usage: render_server SECONDS\n", stderr);
        return lucerna::exit_code::usage;
    }
    try {
        return lucerna::serve(seconds);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "render_server: %s\n", e.what());
        return lucerna::exit_code::failure;
    }
}
