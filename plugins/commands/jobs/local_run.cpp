// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/local_run.h"

#include "core/base/error.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"
#include "plugins/commands/jobs/child_process.h"
#include "plugins/commands/jobs/job_status.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <thread>

namespace lucerna {

namespace {

class LocalRun {
public:
    LocalRun(const JobFolder& job, int processes, bool quiet)
        : job_(job), processes_(static_cast<std::size_t>(processes)), quiet_(quiet) {}

    /// Runs the parts that are not done, then merges. Returns an exit code.
    int run() {
        const InterruptGuard guard;
        for (const int part : job_.missing_parts()) waiting_.push_back(part);
        while (!waiting_.empty() || !running_.empty()) {
            if (InterruptGuard::interrupted()) return stop();
            while (!waiting_.empty() && running_.size() < processes_) start_next();
            if (!collect()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
        if (failed_ > 0) return exit_code::failure;
        return merge();
    }

private:
    static constexpr int most_attempts = 20;

    /// Appends to the log, which is made if it is not there.
    static int open_log(const std::filesystem::path& path) {
        const int log = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
        if (log < 0) {
            throw FileError(
                fmt::format("{} cannot be written: {}", path.string(), std::strerror(errno)));
        }
        return log;
    }

    pid_t start(const std::string& script, const std::filesystem::path& log_path,
                const std::string& part, std::size_t processors) const {
        const int log = open_log(log_path);
        const pid_t child = start_child(
            {{"bash", script},
             job_.path(),
             {{"SLURM_ARRAY_TASK_ID", part}, {"SLURM_CPUS_ON_NODE", std::to_string(processors)}}},
            log);
        close(log);
        return child;
    }

    void start_next() {
        const int part = waiting_.front();
        waiting_.pop_front();
        ++attempts_[part];
        const std::size_t processors = std::thread::hardware_concurrency() / processes_;
        const pid_t child = start("part.sh", job_.log(part), std::to_string(part),
                                  std::max<std::size_t>(processors, 1));
        running_[child] = part;
    }

    /// Takes note of a part that has ended; false if none has.
    bool collect() {
        for (const auto& [child, part] : running_) {
            int status = 0;
            if (waitpid(child, &status, WNOHANG) != child) continue;
            ended(part, exit_code_of(status));
            running_.erase(child);
            return true;
        }
        return false;
    }

    void ended(int part, int code) {
        if (code == 0) {
            if (!quiet_) fmt::print(stderr, "part {} of {} done\n", part, job_.part_count());
        } else if (is_temporary(code) && attempts_[part] < most_attempts) {
            waiting_.push_back(part);
        } else {
            ++failed_;
            fmt::print(stderr, "part {} failed with exit code {}; see {}\n", part, code,
                       job_.log(part).string());
        }
    }

    /// The parts write checkpoints and end.
    int stop() {
        for (const auto& [child, part] : running_) ::kill(-child, SIGTERM);
        for (const auto& [child, part] : running_) {
            while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
            }
        }
        fmt::print(stderr, "interrupted; the same command goes on\n");
        return exit_code::interrupted;
    }

    int merge() const {
        const pid_t child =
            start("merge.sh", job_.merge_log(), "", std::thread::hardware_concurrency());
        int status = 0;
        while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
        }
        const int code = exit_code_of(status);
        if (code != 0) {
            fmt::print(stderr, "{} failed with exit code {}; see {}\n",
                       job_.merge_script().string(), code, job_.merge_log().string());
        }
        return code;
    }

    const JobFolder& job_;
    std::size_t processes_;
    bool quiet_;
    std::deque<int> waiting_;
    std::map<pid_t, int> running_;
    std::map<int, int> attempts_;
    int failed_ = 0;
};

}  // namespace

int run_locally(const JobFolder& job, int processes, bool quiet) {
    return LocalRun(job, processes, quiet).run();
}

}  // namespace lucerna
