// SPDX-License-Identifier: Apache-2.0
/// The packets of tev's protocol that show a picture, as tev's Python client (tevclient 1.0.4)
/// writes them.
///
/// A packet is its length in bytes (uint32, itself included), its type (int8), and its fields
/// without padding, little endian. Booleans are a byte; strings end with a zero byte.
#pragma once

#include "core/image/image.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace lucerna {

class TevPacket {
public:
    enum class Type : std::int8_t { close_image = 2, create_image = 4, update_image = 6 };

    explicit TevPacket(Type type) {
        add<std::uint32_t>(0);
        add(static_cast<std::int8_t>(type));
    }
    template <typename T>
    void add(T value) {
        static_assert(std::is_arithmetic_v<T> && std::endian::native == std::endian::little);
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        bytes_.append(bytes, sizeof(T));
    }
    void add_text(std::string_view text) {
        bytes_.append(text.substr(0, text.find('\0')));
        bytes_ += '\0';
    }
    void add_floats(const float* values, std::size_t count) {
        bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(float));
    }
    /// The finished packet.
    std::string bytes() && {
        const auto size = static_cast<std::uint32_t>(bytes_.size());
        std::memcpy(bytes_.data(), &size, sizeof size);
        return std::move(bytes_);
    }

private:
    std::string bytes_;
};

/// Makes a black picture with channels R, G, B, in place of one of this name, and selects it.
inline std::string tev_create_image(std::string_view name, Vector2i size) {
    TevPacket packet(TevPacket::Type::create_image);
    packet.add<std::int8_t>(1);
    packet.add_text(name);
    packet.add<std::int32_t>(size.x);
    packet.add<std::int32_t>(size.y);
    packet.add<std::int32_t>(3);
    for (const char* channel : {"R", "G", "B"}) packet.add_text(channel);
    return std::move(packet).bytes();
}

/// The pixels `begin` … `begin + size − 1` of an image of R, G and B that lies at `offset`.
inline std::string tev_update_image(std::string_view name, const Image& image, Vector2i offset,
                                    Vector2i begin, Vector2i size) {
    TevPacket packet(TevPacket::Type::update_image);
    packet.add<std::int8_t>(0);
    packet.add_text(name);
    packet.add<std::int32_t>(3);
    for (const char* channel : {"R", "G", "B"}) packet.add_text(channel);
    packet.add<std::int32_t>(offset.x + begin.x);
    packet.add<std::int32_t>(offset.y + begin.y);
    packet.add<std::int32_t>(size.x);
    packet.add<std::int32_t>(size.y);
    for (const std::int64_t first : {0, 1, 2}) packet.add(first);
    for (const std::int64_t stride : {3, 3, 3}) packet.add(stride);
    for (int y = begin.y; y < begin.y + size.y; ++y) {
        packet.add_floats(image.at(begin.x, y), 3 * static_cast<std::size_t>(size.x));
    }
    return std::move(packet).bytes();
}

inline std::string tev_close_image(std::string_view name) {
    TevPacket packet(TevPacket::Type::close_image);
    packet.add_text(name);
    return std::move(packet).bytes();
}

}  // namespace lucerna
