// SPDX-License-Identifier: Apache-2.0
/// Well-formed XML, strictly: what pugixml lets pass (text between elements, repeated attributes,
/// unknown entities, several roots, wrong encodings, any depth) is refused here, once, so that the
/// reader of scenes meets nothing but elements with attributes.
#pragma once

#include "core/base/error.h"

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace pugi {
class xml_document;
struct xml_node_struct;
}  // namespace pugi

namespace lucerna {

/// What a scene may cost at most, over all its files.
struct ReadLimits {
    int max_depth = 64;          ///< of elements in elements
    int max_include_depth = 15;  ///< of files in files
    std::size_t max_bytes = std::size_t{1} << 30;
    std::size_t max_elements = 20'000'000;
    int max_errors = 50;  ///< reading stops there
};

struct XmlAttribute {
    std::string_view name, value;
};

/// A view of an element; valid as long as its document.
class XmlElement {
public:
    XmlElement() = default;
    explicit XmlElement(pugi::xml_node_struct* node) : node_(node) {}
    explicit operator bool() const { return node_ != nullptr; }

    std::string_view name() const;
    std::size_t offset() const;  ///< of its '<' in the text
    std::vector<XmlAttribute> attributes() const;
    XmlElement first_child() const;
    XmlElement next_sibling() const;

private:
    pugi::xml_node_struct* node_ = nullptr;
};

class XmlDocument {
public:
    /// Parses the text of `source` and reports all that is wrong with it as XML.
    /// `elements` counts over several documents against the limit.
    XmlDocument(const SourceFile& source, const ReadLimits& limits, std::size_t& elements,
                Diagnostics& diagnostics);
    ~XmlDocument();
    XmlDocument(const XmlDocument&) = delete;
    XmlDocument& operator=(const XmlDocument&) = delete;

    /// The root element; null if the text cannot be read as XML within the limits.
    XmlElement root() const { return root_; }

private:
    std::unique_ptr<pugi::xml_document> document_;
    XmlElement root_;
};

}  // namespace lucerna
