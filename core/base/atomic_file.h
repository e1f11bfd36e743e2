// SPDX-License-Identifier: Apache-2.0
/// Files that are there completely or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace lucerna {

/// Replaces the file at `path` by `bytes`: whoever reads it, at any time and also after a crash or
/// a power cut, finds the old content or the new one, never a part. The bytes go to a temporary
/// file in the same directory, whose every write, its length and its closing are verified before it
/// takes the name. The permissions of the old file stay, and symbolic links are followed.
/// Devices and pipes are written to directly. Temporary files that writers left in this directory
/// when they were killed are removed.
///
/// Throws FileError with reason and remedy; then the old file is as it was, and nothing is left
/// behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Throws FileError if `write_file_atomically` could not write to `path` as things stand: to be
/// called before hours of rendering. Creates nothing that stays.
void check_writable(const std::filesystem::path& path);

}  // namespace lucerna
