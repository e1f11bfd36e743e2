// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/job_folder.h"

#include "core/base/atomic_file.h"
#include "core/base/error.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <utility>

namespace lucerna {

JobFolder::JobFolder(std::filesystem::path path, std::string name, int parts, std::string extension)
    : path_(std::move(path)),
      name_(std::move(name)),
      parts_(parts),
      extension_(std::move(extension)) {}

bool JobFolder::is_job(const std::filesystem::path& path) {
    return std::filesystem::exists(path / "job.txt");
}

JobFolder JobFolder::read(const std::filesystem::path& path) {
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

void JobFolder::write() const {
    write_file_atomically(path_ / "job.txt", fmt::format("name {}\nparts {}\nresults {}\n", name_,
                                                         parts_, extension_));
}

std::filesystem::path JobFolder::log(int part) const {
    return path_ / "logs" / fmt::format("{}.txt", part);
}

bool JobFolder::is_done(int part) const {
    return std::filesystem::exists(path_ / "parts" / fmt::format("{}.{}", part, extension_));
}

std::vector<int> JobFolder::missing_parts() const {
    std::vector<int> missing;
    for (int part = 1; part <= parts_; ++part) {
        if (!is_done(part)) missing.push_back(part);
    }
    return missing;
}

std::vector<Attempt> JobFolder::attempts(int part) const {
    return read_record(fmt::format("{}.txt", part));
}

std::vector<Attempt> JobFolder::merge_attempts() const { return read_record("merge.txt"); }

std::vector<Attempt> JobFolder::read_record(const std::string& name) const {
    std::vector<Attempt> attempts;
    std::ifstream file(path_ / "records" / name);
    std::string word, argument;
    for (std::int64_t when = 0; file >> word >> when >> argument;) {
        if (word == "start") attempts.push_back({when, argument});
        if (word != "end" || attempts.empty()) continue;
        attempts.back().end = when;
        attempts.back().code = std::atoi(argument.c_str());
    }
    return attempts;
}

std::optional<SlurmJobs> JobFolder::slurm_jobs() const {
    std::ifstream file(path_ / "slurm_jobs.txt");
    std::optional<SlurmJobs> last;
    for (SlurmJobs jobs; file >> jobs.parts >> jobs.merge;) last = jobs;
    return last;
}

void JobFolder::add_slurm_jobs(const SlurmJobs& jobs) const {
    std::ofstream(path_ / "slurm_jobs.txt", std::ios::app)
        << jobs.parts << ' ' << jobs.merge << '\n';
}

}  // namespace lucerna
