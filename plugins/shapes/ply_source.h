// SPDX-License-Identifier: Apache-2.0
/// The numbers of PLY files, as text and as binary data of both byte orders.
#pragma once

#include "plugins/shapes/ply_header.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace lucerna {

/// The numbers of a text file, one after the other.
class PlyTextSource {
public:
    explicit PlyTextSource(TextCursor at) : at_(std::move(at)) {}

    double next(PlyType type) {
        at_.skip_space();
        if (at_.at_end()) at_.fail("the file ends too early");
        if (!is_integer(type)) return at_.number("a value");
        const auto value = static_cast<double>(at_.integer("a value"));
        if (!at_.at_blank()) at_.fail("a value of an integer type should be a whole number");
        return value;
    }
    std::size_t remaining() const { return at_.remaining(); }
    /// Bytes that each value takes at least, with a separator.
    static std::size_t least_size(PlyType) { return 2; }
    /// The last value needs no separator.
    static constexpr std::size_t slack = 1;
    /// More than blanks follows.
    bool has_more() {
        at_.skip_space();
        return !at_.at_end();
    }
    [[noreturn]] void fail(std::string_view message) const { at_.fail(message); }

private:
    TextCursor at_;
};

/// The numbers of a binary file, one after the other.
class PlyBinarySource {
public:
    PlyBinarySource(std::span<const std::uint8_t> bytes, std::string name, bool swap)
        : bytes_(bytes), name_(std::move(name)), swap_(swap) {}

    double next(PlyType type) {
        switch (type) {
            case PlyType::int8:
                return take<std::int8_t>();
            case PlyType::uint8:
                return take<std::uint8_t>();
            case PlyType::int16:
                return take<std::int16_t>();
            case PlyType::uint16:
                return take<std::uint16_t>();
            case PlyType::int32:
                return take<std::int32_t>();
            case PlyType::uint32:
                return take<std::uint32_t>();
            case PlyType::float32:
                return static_cast<double>(take<float>());
            case PlyType::float64:
                break;
        }
        return take<double>();
    }
    std::size_t remaining() const { return bytes_.size(); }
    static std::size_t least_size(PlyType type) { return size_of(type); }
    static constexpr std::size_t slack = 0;
    /// More than blanks follows.
    bool has_more() const {
        constexpr std::string_view blanks(" \t\r\n\0", 5);
        return std::any_of(bytes_.begin(), bytes_.end(), [&](std::uint8_t byte) {
            return blanks.find(static_cast<char>(byte)) == std::string_view::npos;
        });
    }
    [[noreturn]] void fail(std::string_view message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

private:
    template <typename T>
    T take() {
        if (bytes_.size() < sizeof(T)) fail("the file ends too early");
        std::array<std::uint8_t, sizeof(T)> raw;
        std::memcpy(raw.data(), bytes_.data(), sizeof(T));
        bytes_ = bytes_.subspan(sizeof(T));
        if (swap_) std::reverse(raw.begin(), raw.end());
        return std::bit_cast<T>(raw);
    }

    std::span<const std::uint8_t> bytes_;
    std::string name_;
    bool swap_;
};

}  // namespace lucerna
