// SPDX-License-Identifier: Apache-2.0
#include "core/scene/find_file.h"

#include "core/plugin/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

fs::path find(std::string_view name, const std::vector<std::string>& folders, fs::file_type type) {
    std::vector<std::string> tried;
    for (const std::string& folder : folders) {
        const fs::path path = (fs::path(folder) / name).lexically_normal();
        std::error_code ignored;  // what cannot be looked at is not there
        if (!name.empty() && fs::status(path, ignored).type() == type) return path;
        if (std::find(tried.begin(), tried.end(), path.string()) == tried.end()) {
            tried.push_back(path.string());
        }
    }
    const char* const what = type == fs::file_type::directory ? "folder" : "file";
    if (name.empty()) throw Error(fmt::format("the name of a {} is missing", what));
    throw Error(fmt::format("there is no {} \"{}\"\n  looked for {}", what, name,
                            join(tried, "\n  looked for ")));
}

}  // namespace

fs::path find_file(std::string_view name, const std::vector<std::string>& folders) {
    return find(name, folders, fs::file_type::regular);
}

fs::path find_folder(std::string_view name, const std::vector<std::string>& folders) {
    return find(name, folders, fs::file_type::directory);
}

}  // namespace lucerna
