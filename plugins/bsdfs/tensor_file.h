// SPDX-License-Identifier: Apache-2.0
/// Reads tensor files: arrays with names, as the RGL material database stores its measurements
/// (Dupuy and Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and
/// Rendering"; documentation of the database).
///
/// All numbers are little-endian. "tensor_file\0", the version (bytes 1 and 0) and the number of
/// fields (uint32) are followed by a head for each field: length of the name (uint16), name, number
/// of dimensions (uint16), type (uint8), place in the file (uint64), and the size of each dimension
/// (uint64), of which the last changes fastest.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

struct TensorField {
    enum class Type : std::uint8_t {
        uint8 = 1,
        int8,
        uint16,
        int16,
        uint32,
        int32,
        uint64,
        int64,
        float16,
        float32,
        float64
    };

    Type type{};
    std::vector<std::uint64_t> shape;
    std::span<const std::uint8_t> bytes;  ///< all numbers
};

/// The fields of a file in memory, which must outlive them.
class TensorFile {
public:
    /// In a shape that is expected: 2 or more, printed as n.
    static constexpr std::uint64_t any = 0;

    /// Throws Error, which begins with `name`, for what is no such file, is truncated, or has
    /// fields that do not lie within it. The numbers may be anything.
    TensorFile(std::span<const std::uint8_t> bytes, std::string name);

    bool has(std::string_view field) const { return fields_.contains(field); }

    /// Throws Error unless there is a field of this type and shape; a shape may have `any`.
    const TensorField& field(std::string_view field, TensorField::Type type,
                             const std::vector<std::uint64_t>& shape) const;
    /// The numbers of such a field of float32. Throws Error if one is not finite.
    std::vector<float> floats(std::string_view field,
                              const std::vector<std::uint64_t>& shape) const;

    /// The number of numbers of such a field of one dimension, at least one. Throws Error if there
    /// is none.
    std::uint64_t one_dimension(std::string_view field) const;

    /// Throws Error: the file's name, then the message.
    [[noreturn]] void fail(const std::string& message) const;

private:
    class Head;
    const TensorField& find(std::string_view field) const;

    std::string name_;
    std::map<std::string, TensorField, std::less<>> fields_;
};

}  // namespace lucerna
