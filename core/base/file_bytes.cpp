// SPDX-License-Identifier: Apache-2.0
#include "core/base/file_bytes.h"

#include "core/base/error.h"
#include "core/math/sequences.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <span>
#include <system_error>
#include <utility>

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

FileReader::FileReader(const std::filesystem::path& path)
    : path_(path), descriptor_(-1), size_(open_file(path).size) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) {
        throw TransientFileError(fmt::format("{}: opening failed: {}; try again", path.string(),
                                             std::generic_category().message(errno)));
    }
}

FileReader::FileReader(FileReader&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

FileReader::~FileReader() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void FileReader::read(std::uint64_t offset, std::span<std::uint8_t> bytes) const {
    while (!bytes.empty()) {
        const ssize_t count =
            ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) {
            throw TransientFileError(fmt::format("{}: reading failed: {}; try again",
                                                 path_.string(),
                                                 std::generic_category().message(errno)));
        }
        if (count == 0) {
            throw FileError(fmt::format("{}: it ends too early; get it again", path_.string()));
        }
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        offset += static_cast<std::uint64_t>(count);
    }
}

namespace {

/// Four chains, because each multiplication waits for the one before it.
class ChainedHash {
public:
    /// The last words are filled up with zeros; the size tells them from such contents.
    void add(std::span<const std::uint8_t> bytes) {
        size_ += bytes.size();
        Words words;
        for (; bytes.size() >= sizeof words; bytes = bytes.subspan(sizeof words)) {
            std::memcpy(words.data(), bytes.data(), sizeof words);
            add(words);
        }
        if (bytes.empty()) return;
        words.fill(0);
        std::memcpy(words.data(), bytes.data(), bytes.size());
        add(words);
    }
    std::uint64_t value() const {
        return hash64({size_, chains_[0], chains_[1], chains_[2], chains_[3]});
    }

private:
    using Words = std::array<std::uint64_t, 4>;

    void add(const Words& words) {
        for (std::size_t k = 0; k < words.size(); ++k) {
            const std::uint64_t mixed = (chains_[k] ^ words[k]) * 0x9e3779b97f4a7c15u;
            chains_[k] = mixed ^ mixed >> 32;
        }
    }

    std::uint64_t size_ = 0;
    Words chains_ = {1, 2, 3, 4};
};

}  // namespace

std::uint64_t hash_of_bytes(std::span<const std::uint8_t> bytes) {
    ChainedHash hash;
    hash.add(bytes);
    return hash.value();
}

std::uint64_t hash_of_file(const std::filesystem::path& path) {
    OpenFile file = open_file(path);
    ChainedHash hash;
    std::vector<std::uint8_t> block(std::size_t{1} << 18);
    for (std::uintmax_t left = file.size; left > 0;) {
        const std::size_t count = std::min<std::uintmax_t>(left, block.size());
        read(file, std::span(block).first(count), path);
        hash.add(std::span(block).first(count));
        left -= count;
    }
    return hash.value();
}

}  // namespace lucerna
