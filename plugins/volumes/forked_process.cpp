// SPDX-License-Identifier: Apache-2.0
#include "plugins/volumes/forked_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

namespace lucerna {

namespace {

/// A crash ends the process at once: without a dump of its memory, without a word, and without
/// handlers that belong to the program it is a copy of.
void crash_in_silence() {
    for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGPIPE}) {
        std::signal(signal, SIG_DFL);
    }
    const rlimit none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0 || dup2(nowhere, STDERR_FILENO) < 0) {
        _exit(1);
    }
}

/// If memory runs out, the system ends this process rather than the one that waits for it.
void be_first_when_memory_ends() {
    const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    constexpr std::string_view most = "1000";
    [[maybe_unused]] const ssize_t written = write(file, most.data(), most.size());
    close(file);
}

}  // namespace

void ForkedProcess::Output::write(std::span<const std::uint8_t> bytes) const {
    while (!bytes.empty()) {
        const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) _exit(1);
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
}

ForkedProcess::ForkedProcess(const std::function<void(const Output&)>& task) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) {
        throw Error(fmt::format("there can be no pipe: {}", std::strerror(errno)));
    }
    process_ = fork();
    if (process_ == 0) {
        crash_in_silence();
        be_first_when_memory_ends();
        close(ends[0]);
        try {
            task(Output(ends[1]));
        } catch (...) {
            _exit(1);
        }
        _exit(0);
    }
    const int error = errno;
    close(ends[1]);
    input_ = ends[0];
    if (process_ < 0) {
        close(input_);
        throw Error(fmt::format("no process can be started: {}", std::strerror(error)));
    }
}

ForkedProcess::~ForkedProcess() {
    if (process_ > 0) kill(process_, SIGKILL);
    wait();
    close(input_);
}

bool ForkedProcess::read(std::span<std::uint8_t> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::read(input_, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
}

bool ForkedProcess::killed() {
    wait();
    return WIFSIGNALED(status_) && WTERMSIG(status_) == SIGKILL;
}

void ForkedProcess::wait() {
    if (process_ < 0) return;
    while (waitpid(process_, &status_, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
}

}  // namespace lucerna
