// SPDX-License-Identifier: Apache-2.0
#include "tests/paths.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <system_error>

namespace lucerna {

std::filesystem::path tests_folder() { return LUCERNA_TESTS; }

std::filesystem::path program_path() { return LUCERNA_PROGRAM; }

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lucerna-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a folder like " + name);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace lucerna
