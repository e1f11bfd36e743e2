// SPDX-License-Identifier: Apache-2.0
#include "core/base/json.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <utility>

namespace lucerna {

struct Json::Value {
    nlohmann::ordered_json json;
};

Json::Json() : value_(std::make_unique<Value>()) {}
Json::Json(bool value) : Json() { value_->json = value; }
Json::Json(double value) : Json() {
    if (std::isfinite(value)) value_->json = value;
}
Json::Json(const std::string& value) : Json() { value_->json = value; }
Json::Json(Integer value) : Json() {
    if (value.negative) {
        value_->json = static_cast<std::int64_t>(value.bits);
    } else {
        value_->json = value.bits;
    }
}
Json::Json(const Json& other) : value_(std::make_unique<Value>(*other.value_)) {}
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(Json other) noexcept {
    std::swap(value_, other.value_);
    return *this;
}
Json::~Json() = default;

Json Json::object() {
    Json result;
    result.value_->json = nlohmann::ordered_json::object();
    return result;
}

Json Json::array() {
    Json result;
    result.value_->json = nlohmann::ordered_json::array();
    return result;
}

Json& Json::set(const std::string& name, const Json& value) {
    value_->json[name] = value.value_->json;
    return *this;
}

Json& Json::append(const Json& value) {
    value_->json.push_back(value.value_->json);
    return *this;
}

std::string Json::text() const { return dump(2); }

std::string Json::line() const { return dump(-1); }

std::string Json::dump(int indent) const {
    // File names need not be UTF-8; the rest of the text must not be lost for it.
    using Handler = nlohmann::ordered_json::error_handler_t;
    return value_->json.dump(indent, ' ', false, Handler::replace) + "\n";
}

}  // namespace lucerna
