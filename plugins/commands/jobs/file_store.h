// SPDX-License-Identifier: Apache-2.0
/// Copies of files in one folder, each content once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace lucerna {

/// Throws FileError if the folder cannot be made.
void make_folder(const std::filesystem::path& folder);

/// Throws FileError if the file cannot be copied; one that is there is replaced.
void put_copy(const std::filesystem::path& from, const std::filesystem::path& to);

class FileStore {
public:
    explicit FileStore(std::filesystem::path folder);

    /// Copies the file, unless its content is there already. Returns its name in the folder.
    std::string add_file(const std::filesystem::path& path);

    /// Writes a text, unless it is there already.
    std::string add_text(const std::string& name, const std::string& text);

private:
    /// The name with nothing but letters, digits, "_", "-" and ".", so that it needs no quotes in
    /// XML or a shell, and with a number if another file has it.
    std::string free_name(std::string name);

    std::filesystem::path folder_;
    std::set<std::string> names_;
    std::map<std::filesystem::path, std::string> by_path_;
    std::map<std::uint64_t, std::string> by_hash_;
    std::map<std::string, std::string> by_text_;
};

}  // namespace lucerna
