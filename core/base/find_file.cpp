// SPDX-License-Identifier: Apache-2.0
#include "core/base/find_file.h"

#include "core/base/error.h"
#include "core/base/system_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

fs::path find(std::string_view name, const std::vector<std::string>& folders, fs::file_type type) {
    const std::string what = type == fs::file_type::directory ? "folder" : "file";
    std::vector<std::string> tried;
    for (const std::string& folder : folders) {
        const fs::path path = (fs::path(folder) / name).lexically_normal();
        std::error_code problem;
        const fs::file_status status = fs::status(path, problem);
        if (may_pass(problem.value())) {
            throw TransientFileError(fmt::format("{}: looking at it failed: {}; try again",
                                                 path.string(), problem.message()));
        }
        // What cannot be looked at for another reason is not there.
        if (!name.empty() && status.type() == type) return path;
        const std::string remark = fs::exists(status) ? ", which is not a " + what : "";
        if (std::find(tried.begin(), tried.end(), path.string() + remark) == tried.end()) {
            tried.push_back(path.string() + remark);
        }
    }
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
