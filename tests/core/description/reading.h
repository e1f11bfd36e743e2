// SPDX-License-Identifier: Apache-2.0
/// Reading scenes from text in tests.
#pragma once

#include "core/description/xml_reader.h"

#include <gtest/gtest.h>

#include <string>

namespace lucerna {

/// Reads the text; what is wrong with it fails the test.
inline Description read_valid(const std::string& text, const ReadOptions& options = {}) {
    Diagnostics diagnostics;
    Description description = read_scene_text(text, "scene.xml", options, diagnostics);
    for (const Diagnostic& d : diagnostics.all()) ADD_FAILURE() << d.text();
    return description;
}

/// The same, for what stands in a scene of version 3.
inline Description read_content(const std::string& content, const ReadOptions& options = {}) {
    return read_valid("<scene version=\"3.0.0\">" + content + "</scene>", options);
}

/// All that is wrong with the text: "line:column message", one a line.
inline std::string errors_of(const std::string& text, const ReadOptions& options = {}) {
    Diagnostics diagnostics;
    const Description description = read_scene_text(text, "scene.xml", options, diagnostics);
    EXPECT_EQ(description.hash == 0, diagnostics.error_count() > 0);
    std::string result;
    for (const Diagnostic& d : diagnostics.all()) {
        result += std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.message + "\n";
    }
    return result;
}

inline const Property* find_property(const Element& element, const std::string& name) {
    for (const Property& property : element.properties) {
        if (property.name == name) return &property;
    }
    return nullptr;
}

/// The value of a property, which must be there and of type T.
template <typename T>
T value_of(const Element& element, const std::string& name) {
    const Property* const property = find_property(element, name);
    const T* const value = property ? std::get_if<T>(&property->value) : nullptr;
    if (!value) ADD_FAILURE() << name << " is missing or not of this type";
    return value ? *value : T{};
}

}  // namespace lucerna
