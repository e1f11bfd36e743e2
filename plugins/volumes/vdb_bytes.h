// SPDX-License-Identifier: Apache-2.0
/// The bytes of a file of sparse grids, on disk or in memory. To read beyond its end is an error.
#pragma once

#include "core/base/error.h"
#include "core/base/file_bytes.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <type_traits>

namespace lucerna {

class VdbBytes {
public:
    explicit VdbBytes(const std::filesystem::path& path)
        : file_(std::in_place, path), size_(file_->size()), name_(path.filename().string()) {}
    VdbBytes(std::span<const std::uint8_t> memory, const std::string& name)
        : memory_(memory), size_(memory.size()), name_(name) {}

    std::uint64_t size() const { return size_; }
    const std::string& name() const { return name_; }

    /// Fills `bytes` with what begins at `offset`.
    void read(std::uint64_t offset, std::span<std::uint8_t> bytes) const {
        check(offset, bytes.size());
        if (file_) return file_->read(offset, bytes);
        if (!bytes.empty()) std::memcpy(bytes.data(), memory_.data() + offset, bytes.size());
    }
    template <typename T>
    T value(std::uint64_t offset) const {
        static_assert(std::is_trivially_copyable_v<T>);
        std::array<std::uint8_t, sizeof(T)> bytes;
        read(offset, bytes);
        T value;
        std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
        return value;
    }
    std::string text(std::uint64_t offset, std::uint64_t length) const {
        check(offset, length);
        std::string text(length, '\0');
        read(offset, {reinterpret_cast<std::uint8_t*>(text.data()), text.size()});
        return text;
    }
    /// That the file has so many bytes at this place: before memory for them is asked for.
    void check(std::uint64_t offset, std::uint64_t count) const {
        if (offset <= size_ && count <= size_ - offset) return;
        fail(fmt::format("the file ends too early, after {} bytes", size_));
    }
    [[noreturn]] void fail(const std::string& message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

private:
    std::optional<FileReader> file_;
    std::span<const std::uint8_t> memory_;
    std::uint64_t size_;
    std::string name_;
};

}  // namespace lucerna
