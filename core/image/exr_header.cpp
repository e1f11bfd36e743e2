// SPDX-License-Identifier: Apache-2.0
#include "core/image/exr_header.h"

#include "core/base/error.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace lucerna {

namespace {

/// Bytes that are taken from the front; more than there are is an error.
class Bytes {
public:
    explicit Bytes(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

    bool empty() const { return rest_.empty(); }
    /// The next byte is the zero that ends a list, or there is none.
    bool at_end_of_list() const { return rest_.empty() || rest_[0] == 0; }

    Bytes take(std::size_t count) {
        if (count > rest_.size()) throw FileError("an attribute is longer than the file");
        const Bytes taken(rest_.first(count));
        rest_ = rest_.subspan(count);
        return taken;
    }
    std::string_view take_text() {
        const auto end = std::find(rest_.begin(), rest_.end(), 0);
        const Bytes taken = take(static_cast<std::size_t>(end - rest_.begin()));
        take(1);
        return {reinterpret_cast<const char*>(taken.rest_.data()), taken.rest_.size()};
    }
    /// Little-endian.
    std::size_t take_size() {
        const Bytes b = take(4);
        return b.rest_[0] + (std::size_t{b.rest_[1]} << 8) + (std::size_t{b.rest_[2]} << 16) +
               (std::size_t{b.rest_[3]} << 24);
    }
    std::size_t size() const { return rest_.size(); }

private:
    std::span<const std::uint8_t> rest_;
};

struct TypeSize {
    std::string_view type;
    std::size_t size;
};

/// Sizes of the types whose size never changes ("OpenEXR File Layout", attribute types).
constexpr std::array type_sizes{
    TypeSize{"box2f", 16},
    TypeSize{"box2i", 16},
    TypeSize{"chromaticities", 32},
    TypeSize{"compression", 1},
    TypeSize{"deepImageState", 1},
    TypeSize{"double", 8},
    TypeSize{"envmap", 1},
    TypeSize{"float", 4},
    TypeSize{"int", 4},
    TypeSize{"keycode", 28},
    TypeSize{"lineOrder", 1},
    TypeSize{"m33d", 72},
    TypeSize{"m33f", 36},
    TypeSize{"m44d", 128},
    TypeSize{"m44f", 64},
    TypeSize{"rational", 8},
    TypeSize{"tiledesc", 9},
    TypeSize{"timecode", 8},
    TypeSize{"v2d", 16},
    TypeSize{"v2f", 8},
    TypeSize{"v2i", 8},
    TypeSize{"v3d", 24},
    TypeSize{"v3f", 12},
    TypeSize{"v3i", 12},
};

/// Takes what an attribute of this type must hold; nothing may be left over.
void check_value(std::string_view type, Bytes value) {
    const auto known = std::find_if(type_sizes.begin(), type_sizes.end(),
                                    [&](const TypeSize& t) { return t.type == type; });
    if (known != type_sizes.end()) {
        value.take(known->size);
    } else if (type == "chlist") {
        constexpr std::size_t channel_size = 16;  // pixel type, flags, sampling
        while (!value.at_end_of_list()) {
            value.take_text();
            value.take(channel_size);
        }
        value.take(1);
    } else if (type == "preview") {
        const std::size_t width = value.take_size(), height = value.take_size();
        if (height > 0 && width > value.size() / height) value.take(value.size() + 1);
        value.take(4 * width * height);
    } else if (type == "stringvector") {
        while (!value.empty()) value.take(value.take_size());
    } else if (type == "idmanifest") {
        throw FileError("it has an attribute of type idmanifest, which is not supported");
    } else {
        return;  // All others are taken as they are.
    }
    if (!value.empty()) throw FileError("an attribute has not the size of its type");
}

}  // namespace

int check_exr_header(std::span<const std::uint8_t> bytes) {
    Bytes rest(bytes);
    rest.take_size();  // the magic number
    constexpr std::size_t many_parts = 0x1000;
    const std::size_t flags = rest.take_size();
    int parts = 0;
    do {
        ++parts;
        while (!rest.at_end_of_list()) {
            rest.take_text();
            const std::string_view type = rest.take_text();
            const std::size_t size = rest.take_size();
            check_value(type, rest.take(size));
        }
        rest.take(1);
    } while ((flags & many_parts) != 0 && !rest.at_end_of_list());
    return parts;
}

}  // namespace lucerna
