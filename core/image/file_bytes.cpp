// SPDX-License-Identifier: Apache-2.0
#include "core/image/file_bytes.h"

#include "core/math/sequences.h"
#include "core/plugin/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <new>
#include <span>
#include <system_error>

namespace lucerna {

namespace {

/// A regular file that is open for reading, and its size.
struct OpenFile {
    std::ifstream stream;
    std::uintmax_t size = 0;
};

OpenFile open_file(const std::filesystem::path& path) {
    const std::string name = path.string();
    std::error_code code;
    const std::filesystem::file_status status = std::filesystem::status(path, code);
    if (status.type() == std::filesystem::file_type::not_found) {
        throw FileError(fmt::format("{}: there is no such file", name));
    }
    if (std::filesystem::is_directory(status)) {
        throw FileError(fmt::format("{}: is a directory; name a file in it", name));
    }
    if (!std::filesystem::is_regular_file(status)) {
        const bool unknown = code || status.type() == std::filesystem::file_type::none;
        throw FileError(fmt::format("{}: {}", name,
                                    unknown ? "cannot be read: " + code.message()
                                            : "is a pipe or a device; only regular files are read, "
                                              "copy the data to one"));
    }
    OpenFile file;
    file.size = std::filesystem::file_size(path, code);
    file.stream.open(path, std::ios::binary);
    if (code || !file.stream) {
        throw FileError(
            fmt::format("{}: cannot be opened for reading; check its permissions", name));
    }
    return file;
}

/// Fills `bytes` with what comes next in the file.
void read(OpenFile& file, std::span<std::uint8_t> bytes, const std::filesystem::path& path) {
    const auto wanted = static_cast<std::streamsize>(bytes.size());
    file.stream.read(reinterpret_cast<char*>(bytes.data()), wanted);
    if (file.stream.gcount() == wanted) return;
    throw TransientFileError(
        fmt::format("{}: {} of its {} bytes could not be read; is it being written?", path.string(),
                    wanted - file.stream.gcount(), file.size));
}

}  // namespace

std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path) {
    OpenFile file = open_file(path);
    std::vector<std::uint8_t> bytes;
    try {
        bytes.resize(file.size);
    } catch (const std::exception&) {
        throw FileError(
            fmt::format("{}: its {} bytes do not fit into memory", path.string(), file.size));
    }
    read(file, bytes, path);
    return bytes;
}

std::uint64_t hash_of_file(const std::filesystem::path& path) {
    OpenFile file = open_file(path);
    // Four chains, because each multiplication waits for the one before it.
    std::array<std::uint64_t, 4> chains = {1, 2, 3, 4};
    std::vector<std::uint8_t> block(std::size_t{1} << 18);
    for (std::uintmax_t left = file.size; left > 0;) {
        const std::size_t count = std::min<std::uintmax_t>(left, block.size());
        read(file, std::span(block).first(count), path);
        // The last words are filled up with zeros; the size tells them from such contents.
        std::fill(block.begin() + static_cast<std::ptrdiff_t>(count), block.end(), std::uint8_t{0});
        for (std::size_t i = 0; i < count; i += sizeof chains) {
            std::array<std::uint64_t, 4> words;
            std::memcpy(words.data(), block.data() + i, sizeof words);
            for (std::size_t k = 0; k < words.size(); ++k) {
                const std::uint64_t mixed = (chains[k] ^ words[k]) * 0x9e3779b97f4a7c15u;
                chains[k] = mixed ^ mixed >> 32;
            }
        }
        left -= count;
    }
    return hash64({file.size, chains[0], chains[1], chains[2], chains[3]});
}

}  // namespace lucerna
