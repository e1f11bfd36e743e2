// SPDX-License-Identifier: Apache-2.0
#include "core/base/file_bytes.h"

#include "core/base/error.h"
#include "core/base/system_error.h"
#include "core/math/sequences.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace lucerna {

namespace {

[[noreturn]] void fail_reading(const std::filesystem::path& path, std::string_view doing,
                               int error) {
    const std::string message = fmt::format("{}: {} failed: {}", path.string(), doing,
                                            std::generic_category().message(error));
    if (may_pass(error)) throw TransientFileError(message + "; try again");
    if (error == EACCES || error == EPERM) throw FileError(message + "; check its permissions");
    throw FileError(message);
}

/// Its size; throws unless it is a regular file.
std::uint64_t regular_size(const std::filesystem::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) {
        if (errno != ENOENT && errno != ENOTDIR) fail_reading(path, "looking at it", errno);
        throw FileError(fmt::format("{}: there is no such file", path.string()));
    }
    if (S_ISDIR(status.st_mode)) {
        throw FileError(fmt::format("{}: is a directory; name a file in it", path.string()));
    }
    if (!S_ISREG(status.st_mode)) {
        throw FileError(fmt::format(
            "{}: is a pipe or a device; only regular files are read, copy the data to one",
            path.string()));
    }
    return static_cast<std::uint64_t>(status.st_size);
}

}  // namespace

std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path) {
    const FileReader file(path);
    std::vector<std::uint8_t> bytes;
    try {
        bytes.resize(file.size());
    } catch (const std::exception&) {
        throw FileError(
            fmt::format("{}: its {} bytes do not fit into memory", path.string(), file.size()));
    }
    file.read(0, bytes);
    return bytes;
}

FileReader::FileReader(const std::filesystem::path& path)
    : path_(path), descriptor_(-1), size_(regular_size(path)) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail_reading(path, "opening it for reading", errno);
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
        if (count < 0) fail_reading(path_, "reading", errno);
        if (count == 0) {
            throw TransientFileError(
                fmt::format("{}: its last {} bytes are not there; is it being "
                            "written?",
                            path_.string(), bytes.size()));
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
    const FileReader file(path);
    ChainedHash hash;
    std::vector<std::uint8_t> block(std::size_t{1} << 18);
    for (std::uint64_t offset = 0; offset < file.size();) {
        const std::size_t count = std::min<std::uint64_t>(file.size() - offset, block.size());
        file.read(offset, std::span(block).first(count));
        hash.add(std::span(block).first(count));
        offset += count;
    }
    return hash.value();
}

}  // namespace lucerna
