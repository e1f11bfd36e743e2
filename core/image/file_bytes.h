// SPDX-License-Identifier: Apache-2.0
/// Reading a whole file, with an error that says what is in its place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace lucerna {

/// The bytes of a regular file. Throws FileError for a missing or unreadable file, a directory, and
/// for pipes and devices, which could block or never end.
std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path);

/// A hash of size and contents, to tell whether a file has changed: no protection against malice.
/// The same on every little-endian machine. Throws as read_file_bytes.
std::uint64_t hash_of_file(const std::filesystem::path& path);

}  // namespace lucerna
