// SPDX-License-Identifier: Apache-2.0
#include "plugins/bsdfs/tensor_file.h"

#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace lucerna {

namespace {

static_assert(std::endian::native == std::endian::little, "the format is read as it is stored");

constexpr std::string_view magic("tensor_file\0", 12);

struct TypeFacts {
    const char* name;
    std::uint64_t bytes;
};
/// By TensorField::Type.
constexpr std::array<TypeFacts, 12> types{{{"", 0},
                                           {"uint8", 1},
                                           {"int8", 1},
                                           {"uint16", 2},
                                           {"int16", 2},
                                           {"uint32", 4},
                                           {"int32", 4},
                                           {"uint64", 8},
                                           {"int64", 8},
                                           {"float16", 2},
                                           {"float32", 4},
                                           {"float64", 8}}};

const TypeFacts& facts(TensorField::Type type) { return types[static_cast<std::size_t>(type)]; }

/// "2 × 3 × n", with `zero` for a 0.
std::string text(const std::vector<std::uint64_t>& shape, const char* zero = "0") {
    std::string result;
    for (const std::uint64_t size : shape) {
        if (!result.empty()) result += " × ";
        result += size == 0 ? zero : fmt::format("{}", size);
    }
    return result.empty() ? "()" : result;
}

}  // namespace

/// Takes numbers and words from the head of the file, one after the other.
class TensorFile::Head {
public:
    Head(const TensorFile& file, std::span<const std::uint8_t> bytes)
        : file_(file), size_(bytes.size()), rest_(bytes) {}

    template <typename T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }

    std::string word(std::size_t length) {
        const std::span<const std::uint8_t> letters = take(length);
        return {letters.begin(), letters.end()};
    }

private:
    std::span<const std::uint8_t> take(std::size_t count) {
        if (rest_.size() < count) {
            file_.fail(
                fmt::format("the file ends after {} bytes, within its list of fields", size_));
        }
        const std::span<const std::uint8_t> taken = rest_.first(count);
        rest_ = rest_.subspan(count);
        return taken;
    }

    const TensorFile& file_;
    std::size_t size_;
    std::span<const std::uint8_t> rest_;
};

TensorFile::TensorFile(std::span<const std::uint8_t> bytes, std::string name)
    : name_(std::move(name)) {
    const std::size_t common = std::min(bytes.size(), magic.size());
    if (common == 0 || std::memcmp(bytes.data(), magic.data(), common) != 0) {
        fail("this is not a tensor file, which begins with \"tensor_file\"");
    }
    Head head(*this, bytes);
    head.word(magic.size());
    const int major = head.number<std::uint8_t>(), minor = head.number<std::uint8_t>();
    if (major != 1 || minor != 0) {
        fail(fmt::format("version {}.{} of the format cannot be read, only 1.0", major, minor));
    }
    const auto count = head.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string field_name = head.word(head.number<std::uint16_t>());
        const int dimensions = head.number<std::uint16_t>();
        const int type = head.number<std::uint8_t>();
        const auto offset = head.number<std::uint64_t>();
        TensorField field;
        for (int k = 0; k < dimensions; ++k) field.shape.push_back(head.number<std::uint64_t>());
        if (type < 1 || type >= static_cast<int>(types.size())) {
            fail(fmt::format("field {} has the type {}; there are 1 to {}", quote(field_name), type,
                             types.size() - 1));
        }
        field.type = static_cast<TensorField::Type>(type);
        // Products may overflow, so what is left of the file is divided instead.
        const std::uint64_t room = offset <= bytes.size() ? bytes.size() - offset : 0;
        const bool empty = std::ranges::find(field.shape, 0u) != field.shape.end();
        std::uint64_t possible = room / facts(field.type).bytes;
        std::uint64_t needed = empty ? 0 : facts(field.type).bytes;
        for (const std::uint64_t size : field.shape) {
            if (empty) break;
            possible /= size;
            needed *= size;
        }
        if (offset > bytes.size() || (!empty && possible == 0)) {
            fail(
                fmt::format("field {}, {} of type {} from byte {}, goes beyond the end of the "
                            "file of {} bytes",
                            quote(field_name), text(field.shape), facts(field.type).name, offset,
                            bytes.size()));
        }
        field.bytes = bytes.subspan(offset, needed);
        if (!fields_.emplace(field_name, std::move(field)).second) {
            fail(fmt::format("there are two fields {}", quote(field_name)));
        }
    }
}

const TensorField& TensorFile::find(std::string_view field) const {
    const auto found = fields_.find(field);
    if (found != fields_.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, value] : fields_) names.push_back(quote(name));
    fail(fmt::format("there is no field \"{}\"; there are: {}", field,
                     names.empty() ? "none" : join(names)));
}

const TensorField& TensorFile::field(std::string_view field, TensorField::Type type,
                                     const std::vector<std::uint64_t>& shape) const {
    const TensorField& it = find(field);
    if (it.type != type) {
        fail(fmt::format("field \"{}\" is of type {}, not {}", field, facts(it.type).name,
                         facts(type).name));
    }
    const auto fits = [](std::uint64_t size, std::uint64_t wanted) {
        return wanted == any ? size >= 2 : size == wanted;
    };
    if (!std::ranges::equal(it.shape, shape, fits)) {
        const bool free = std::ranges::find(shape, any) != shape.end();
        fail(fmt::format("field \"{}\" has the shape {}, not {}{}", field, text(it.shape),
                         text(shape, "n"), free ? ", where n is 2 or more" : ""));
    }
    return it;
}

std::uint64_t TensorFile::one_dimension(std::string_view field) const {
    const TensorField& it = find(field);
    if (it.shape.size() != 1 || it.shape[0] == 0) {
        fail(fmt::format("field \"{}\" has the shape {}, not one dimension of 1 or more", field,
                         text(it.shape)));
    }
    return it.shape[0];
}

std::vector<float> TensorFile::floats(std::string_view name,
                                      const std::vector<std::uint64_t>& shape) const {
    const TensorField& it = field(name, TensorField::Type::float32, shape);
    std::vector<float> numbers(it.bytes.size() / sizeof(float));
    if (!numbers.empty()) std::memcpy(numbers.data(), it.bytes.data(), it.bytes.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (!std::isfinite(numbers[i])) {
            fail(fmt::format("number {} of field \"{}\" is not finite: {}", i, name, numbers[i]));
        }
    }
    return numbers;
}

void TensorFile::fail(const std::string& message) const {
    throw Error(fmt::format("{}: {}", name_, message));
}

}  // namespace lucerna
