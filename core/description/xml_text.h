// SPDX-License-Identifier: Apache-2.0
/// The text of an XML file as such, for what a parser does not tell: whether it is UTF-8, where the
/// values of attributes stand, which elements are open.
#pragma once

#include "core/base/error.h"

#include <string>
#include <string_view>

namespace lucerna {

/// True if the text is UTF-8 without control characters; reports what it is otherwise.
bool check_encoding(const SourceFile& source, Diagnostics& diagnostics);

/// The innermost element that is open at `end`, as the offset of its '<'; npos if there is none.
std::size_t open_element(std::string_view text, std::size_t end);

/// The name of an element or attribute that starts at `start`.
std::string_view name_at(std::string_view text, std::size_t start);

/// An attribute as it is written, before references like &amp; are replaced.
struct RawAttribute {
    std::string_view name;
    std::size_t offset;  ///< of the value in the text
    std::string_view value;
};

/// Behind the name of the element whose '<' is at `element_offset`.
std::size_t after_name(std::string_view text, std::size_t element_offset);

/// The next attribute of a well-formed start tag, from `position` on, which is moved behind it.
bool next_attribute(std::string_view text, std::size_t& position, RawAttribute& attribute);

/// Where the value of an attribute starts in the text, for the element at `element_offset`; the
/// offset of the element if it has no such attribute.
std::size_t attribute_value_offset(std::string_view text, std::size_t element_offset,
                                   std::string_view attribute);

/// What is wrong with a value as it is written: a bare '<' or '&', or an entity that is not one of
/// XML's own. Empty if nothing is. `at` is where.
std::string value_error(std::string_view raw, std::size_t& at);

}  // namespace lucerna
