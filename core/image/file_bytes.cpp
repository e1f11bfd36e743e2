// SPDX-License-Identifier: Apache-2.0
#include "core/image/file_bytes.h"

#include <fmt/format.h>

#include <fstream>
#include <new>
#include <system_error>

#include "core/plugin/error.h"

namespace lucerna {

std::vector<std::uint8_t> read_file_bytes(const std::filesystem::path& path) {
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
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    std::ifstream stream(path, std::ios::binary);
    if (code || !stream) {
        throw FileError(
            fmt::format("{}: cannot be opened for reading; check its permissions", name));
    }
    std::vector<std::uint8_t> bytes;
    try {
        bytes.resize(size);
    } catch (const std::exception&) {
        throw FileError(fmt::format("{}: its {} bytes do not fit into memory", name, size));
    }
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (stream.gcount() != static_cast<std::streamsize>(size)) {
        throw FileError(
            fmt::format("{}: only {} of its {} bytes could be read; is it being written?", name,
                        stream.gcount(), size));
    }
    return bytes;
}

}  // namespace lucerna
