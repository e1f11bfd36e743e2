// SPDX-License-Identifier: Apache-2.0
/// Reading a whole file into memory, with an error that says what is in its place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace lucerna {

/// The bytes of a regular file. Throws FileError for a missing or unreadable file, a directory, and
/// for pipes and devices, which could block or never end.
std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path);

}  // namespace lucerna
