// SPDX-License-Identifier: Apache-2.0
/// Reading a whole file, with an error that says what is in its place.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace lucerna {

/// The bytes of a regular file. Throws FileError for a missing or unreadable file, a directory, and
/// for pipes and devices, which could block or never end.
std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path);

/// The text without the mark that says that it is UTF-8.
constexpr std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

/// A regular file that is read in pieces, by several threads if need be.
class FileReader {
public:
    /// Throws as read_file_bytes.
    explicit FileReader(const std::filesystem::path& path);
    ~FileReader();
    FileReader(FileReader&& other) noexcept;
    FileReader& operator=(FileReader&&) = delete;

    std::uint64_t size() const { return size_; }
    /// Fills `bytes` with what begins at `offset`. Throws FileError if there is not so much.
    void read(std::uint64_t offset, std::span<std::uint8_t> bytes) const;

private:
    std::filesystem::path path_;
    int descriptor_;
    std::uint64_t size_;
};

/// A hash of bytes in memory; a change of one byte changes it. The same on little-endian machines.
std::uint64_t hash_of_bytes(std::span<const std::uint8_t> bytes);

/// A hash of size and contents, to tell whether a file has changed: no protection against malice.
/// The same on every little-endian machine. Throws as read_file_bytes.
std::uint64_t hash_of_file(const std::filesystem::path& path);

}  // namespace lucerna
