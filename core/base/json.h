// SPDX-License-Identifier: Apache-2.0
/// JSON to be written. json.cpp is the only user of nlohmann's library.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// A value; objects keep the order in which members are set. Numbers that JSON cannot hold (NaN,
/// infinities) become null.
class Json {
public:
    Json();  ///< null
    Json(bool value);
    Json(double value);
    Json(const std::string& value);
    Json(const char* value) : Json(std::string(value)) {}
    template <std::integral T>
    Json(T value) : Json(Integer{static_cast<std::uint64_t>(value), value < T(0)}) {}
    template <typename T>
    Json(const std::optional<T>& value) : Json(value ? Json(*value) : Json()) {}
    template <typename T>
    Json(const std::vector<T>& values) : Json(array()) {
        for (const T& value : values) append(value);
    }
    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(Json other) noexcept;
    ~Json();

    static Json object();
    static Json array();

    /// Sets a member of an object.
    Json& set(const std::string& name, const Json& value);
    /// Adds an element to an array.
    Json& append(const Json& value);

    /// Indented text, with a newline at the end.
    std::string text() const;
    /// The same in one line, with a newline at its end.
    std::string line() const;

private:
    struct Integer {
        std::uint64_t bits;
        bool negative;
    };
    struct Value;
    explicit Json(Integer value);
    /// Spaces for each level, or −1 for one line.
    std::string dump(int indent) const;
    std::unique_ptr<Value> value_;
};

}  // namespace lucerna
