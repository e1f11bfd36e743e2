// SPDX-License-Identifier: Apache-2.0
/// Damaging files in every way, reproducibly, for the tests of image readers.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace lucerna {

using Bytes = std::vector<std::uint8_t>;

inline Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

/// Bytes from pairs of hexadecimal digits.
inline Bytes from_hex(std::string_view hex) {
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(
            static_cast<std::uint8_t>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16)));
    }
    return bytes;
}

/// The message of the FileError that `action` must throw.
inline std::string file_error(const std::function<void()>& action) {
    try {
        action();
    } catch (const FileError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no FileError was thrown";
    return "";
}

/// Every shorter piece of a file must be refused with an error that begins with its name.
inline void expect_prefixes_refused(const Bytes& file,
                                    const std::function<void(const Bytes&)>& read) {
    for (std::size_t size = 0; size < file.size(); ++size) {
        const Bytes piece(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size));
        const std::string message = file_error([&] { read(piece); });
        ASSERT_TRUE(message.starts_with("damaged.img: ")) << size << " bytes: " << message;
    }
}

/// 200 copies with one to eight changed bytes must be read or refused, and nothing else. Returns
/// how many were refused.
inline int count_refused_mutants(const Bytes& file, const std::function<void(const Bytes&)>& read) {
    std::mt19937 random(20240717);
    int refused = 0;
    for (int i = 0; i < 200; ++i) {
        Bytes mutant = file;
        const std::size_t changes = 1 + random() % 8;
        for (std::size_t k = 0; k < changes; ++k) {
            const std::size_t at = random() % mutant.size();
            mutant[at] = static_cast<std::uint8_t>(random());
        }
        try {
            read(mutant);
        } catch (const FileError& error) {
            ++refused;
            EXPECT_TRUE(std::string_view(error.what()).starts_with("damaged.img: "))
                << error.what();
        }
    }
    return refused;
}

}  // namespace lucerna
