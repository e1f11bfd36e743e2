// SPDX-License-Identifier: Apache-2.0
/// Copies of files in one folder, each content once.
#pragma once

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/base/file_bytes.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace lucerna {

/// Throws FileError if the folder cannot be made.
inline void make_folder(const std::filesystem::path& folder) {
    std::error_code problem;
    std::filesystem::create_directories(folder, problem);
    if (problem) {
        throw FileError(
            fmt::format("the folder {} cannot be made: {}", folder.string(), problem.message()));
    }
}

/// Throws FileError if the file cannot be copied; one that is there is replaced.
inline void put_copy(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code problem;
    std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing,
                               problem);
    if (problem) {
        throw FileError(fmt::format("{} cannot be copied to {}: {}", from.string(), to.string(),
                                    problem.message()));
    }
}

class FileStore {
public:
    explicit FileStore(std::filesystem::path folder) : folder_(std::move(folder)) {
        make_folder(folder_);
    }

    /// Copies the file, unless its content is there already. Returns its name in the folder.
    std::string add_file(const std::filesystem::path& path) {
        const std::filesystem::path file = std::filesystem::canonical(path);
        if (const auto known = by_path_.find(file); known != by_path_.end()) return known->second;
        const auto [content, is_new] = by_hash_.try_emplace(hash_of_file(file));
        if (is_new) {
            content->second = free_name(path.filename().string());
            put_copy(file, folder_ / content->second);
        }
        return by_path_[file] = content->second;
    }

    /// Writes a text, unless it is there already.
    std::string add_text(const std::string& name, const std::string& text) {
        const auto [content, is_new] = by_text_.try_emplace(text);
        if (is_new) {
            content->second = free_name(name);
            write_file_atomically(folder_ / content->second, text);
        }
        return content->second;
    }

private:
    /// The name with nothing but letters, digits, "_", "-" and ".", so that it needs no quotes in
    /// XML or a shell, and with a number if another file has it.
    std::string free_name(std::string name) {
        for (char& c : name) {
            const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                               (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
            if (!plain) c = '_';
        }
        const std::filesystem::path path(name);
        for (int n = 2; !names_.insert(name).second; ++n) {
            name = fmt::format("{}-{}{}", path.stem().string(), n, path.extension().string());
        }
        return name;
    }

    std::filesystem::path folder_;
    std::set<std::string> names_;
    std::map<std::filesystem::path, std::string> by_path_;
    std::map<std::uint64_t, std::string> by_hash_;
    std::map<std::string, std::string> by_text_;
};

}  // namespace lucerna
