// SPDX-License-Identifier: Apache-2.0
/// The folder of a job: what lies where, and how far each part is.
///
///     job.txt                what the job is
///     part.sh, merge.sh      what is run (job_scripts.h)
///     scene/, plugins/       what the parts read (scene_pack.h)
///     parts/7.exr            the result of part 7, there only when the part is done
///     records/7.txt          when and where part 7 was started and ended, with exit codes
///     logs/7.txt             what part 7 printed
///     slurm_jobs.txt         Slurm's numbers of the jobs that were submitted, the last one last
#pragma once

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "plugins/commands/farm/file_store.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// One line of a record: "start 1767225600 node7", "end 1767229200 0".
struct Attempt {
    std::int64_t start = 0;  ///< seconds since 1970
    std::string host;
    std::optional<std::int64_t> end = {};  ///< empty while it runs, or if its node failed
    int code = 0;                          ///< exit code
};

class JobFolder {
public:
    /// A new job. `extension` is that of the results of parts.
    JobFolder(std::filesystem::path path, std::string name, int parts, std::string extension)
        : path_(std::move(path)),
          name_(std::move(name)),
          parts_(parts),
          extension_(std::move(extension)) {}

    static bool is_job(const std::filesystem::path& path) {
        return std::filesystem::exists(path / "job.txt");
    }

    /// A job that is there.
    static JobFolder read(const std::filesystem::path& path) {
        std::ifstream file(path / "job.txt");
        std::string name_key, name, parts_key, results_key, extension;
        int parts = 0;
        file >> name_key >> name >> parts_key >> parts >> results_key >> extension;
        if (!file || name_key != "name" || parts_key != "parts" || results_key != "results" ||
            parts < 1) {
            throw FileError(fmt::format("{} is no description of a job; pack the job anew",
                                        (path / "job.txt").string()));
        }
        return {path, name, parts, extension};
    }

    void write() const {
        write_file_atomically(path_ / "job.txt", fmt::format("name {}\nparts {}\nresults {}\n",
                                                             name_, parts_, extension_));
    }

    const std::filesystem::path& path() const { return path_; }
    const std::string& name() const { return name_; }
    int part_count() const { return parts_; }
    std::filesystem::path part_script() const { return path_ / "part.sh"; }
    std::filesystem::path merge_script() const { return path_ / "merge.sh"; }
    std::filesystem::path log(int part) const {
        return path_ / "logs" / fmt::format("{}.txt", part);
    }

    bool is_done(int part) const {
        return std::filesystem::exists(path_ / "parts" / fmt::format("{}.{}", part, extension_));
    }
    std::vector<int> missing_parts() const {
        std::vector<int> missing;
        for (int part = 1; part <= parts_; ++part) {
            if (!is_done(part)) missing.push_back(part);
        }
        return missing;
    }

    /// In the order of time. A line that is not complete yet is left out.
    std::vector<Attempt> attempts(int part) const {
        std::vector<Attempt> attempts;
        std::ifstream file(path_ / "records" / fmt::format("{}.txt", part));
        std::string word, argument;
        for (std::int64_t when = 0; file >> word >> when >> argument;) {
            if (word == "start") attempts.push_back({when, argument});
            if (word != "end" || attempts.empty()) continue;
            attempts.back().end = when;
            attempts.back().code = std::atoi(argument.c_str());
        }
        return attempts;
    }

    /// The last number that Slurm gave to the array of parts.
    std::optional<std::string> slurm_job() const {
        std::ifstream file(path_ / "slurm_jobs.txt");
        std::optional<std::string> last;
        for (std::string parts, merge; file >> parts >> merge;) last = parts;
        return last;
    }
    void add_slurm_job(const std::string& parts, const std::string& merge) const {
        std::ofstream(path_ / "slurm_jobs.txt", std::ios::app) << parts << ' ' << merge << '\n';
    }

private:
    std::filesystem::path path_;
    std::string name_;
    int parts_;
    std::string extension_;
};

}  // namespace lucerna
