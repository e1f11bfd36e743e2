// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/jobs/file_store.h"

#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/base/file_bytes.h"

#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace lucerna {

void make_folder(const std::filesystem::path& folder) {
    std::error_code problem;
    std::filesystem::create_directories(folder, problem);
    if (problem) {
        throw FileError(
            fmt::format("the folder {} cannot be made: {}", folder.string(), problem.message()));
    }
}

void put_copy(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code problem;
    std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing,
                               problem);
    if (problem) {
        throw FileError(fmt::format("{} cannot be copied to {}: {}", from.string(), to.string(),
                                    problem.message()));
    }
}

FileStore::FileStore(std::filesystem::path folder) : folder_(std::move(folder)) {
    make_folder(folder_);
}

std::string FileStore::add_file(const std::filesystem::path& path) {
    const std::filesystem::path file = std::filesystem::canonical(path);
    if (const auto known = by_path_.find(file); known != by_path_.end()) return known->second;
    const auto [content, is_new] = by_hash_.try_emplace(hash_of_file(file));
    if (is_new) {
        content->second = free_name(path.filename().string());
        put_copy(file, folder_ / content->second);
    }
    return by_path_[file] = content->second;
}

std::string FileStore::add_text(const std::string& name, const std::string& text) {
    const auto [content, is_new] = by_text_.try_emplace(text);
    if (is_new) {
        content->second = free_name(name);
        write_file_atomically(folder_ / content->second, text);
    }
    return content->second;
}

std::string FileStore::free_name(std::string name) {
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

}  // namespace lucerna
