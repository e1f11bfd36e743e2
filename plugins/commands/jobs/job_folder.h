// SPDX-License-Identifier: Apache-2.0
/// The folder of a job: what lies where, and how far each part is.
///
///     job.txt                what the job is
///     part.sh, merge.sh      what is run (job_scripts.h)
///     scene/, plugins/       what the parts read (scene_pack.h)
///     parts/7.exr            the result of part 7, there only when the part is done
///     records/7.txt          when and where part 7 was started and ended, with exit codes
///     logs/7.txt             what part 7 printed
///     records/merge.txt, logs/merge.txt    the same of the merge
///     slurm_jobs.txt         Slurm's numbers of the jobs that were submitted, the last one last
#pragma once

#include <cstdint>
#include <filesystem>
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

/// Slurm's numbers of the array of parts, "-" if there was none to run, and of the merge.
struct SlurmJobs {
    std::string parts, merge;
};

class JobFolder {
public:
    /// A new job. `extension` is that of the results of parts.
    JobFolder(std::filesystem::path path, std::string name, int parts, std::string extension);

    static bool is_job(const std::filesystem::path& path);

    /// A job that is there.
    static JobFolder read(const std::filesystem::path& path);

    void write() const;

    const std::filesystem::path& path() const { return path_; }
    const std::string& name() const { return name_; }
    int part_count() const { return parts_; }
    std::filesystem::path part_script() const { return path_ / "part.sh"; }
    std::filesystem::path merge_script() const { return path_ / "merge.sh"; }
    std::filesystem::path log(int part) const;
    std::filesystem::path merge_log() const { return path_ / "logs" / "merge.txt"; }

    bool is_done(int part) const;
    std::vector<int> missing_parts() const;

    /// In the order of time. A line that is not complete yet is left out.
    std::vector<Attempt> attempts(int part) const;
    std::vector<Attempt> merge_attempts() const;

    /// The last numbers that Slurm gave.
    std::optional<SlurmJobs> slurm_jobs() const;
    void add_slurm_jobs(const SlurmJobs& jobs) const;

private:
    std::vector<Attempt> read_record(const std::string& name) const;

    std::filesystem::path path_;
    std::string name_;
    int parts_;
    std::string extension_;
};

}  // namespace lucerna
