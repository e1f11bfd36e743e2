// SPDX-License-Identifier: Apache-2.0
/// Where tests find things, and a folder to write to.
#pragma once

#include <filesystem>

namespace lucerna {

/// The folder tests/ of the source tree.
std::filesystem::path tests_folder();

/// The program `lucerna` of the same build.
std::filesystem::path program_path();

/// An empty folder that is removed with the object.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::filesystem::path& name) const {
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

}  // namespace lucerna
