// SPDX-License-Identifier: Apache-2.0
/// An element of a scene file while it is read: its name, its attributes with parameters replaced,
/// and what it accepts.
#pragma once

#include "core/description/definitions.h"
#include "core/description/xml_document.h"

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Where reading stands: the same for all elements of one file, but for `in_emitter`.
struct ReadContext {
    const SourceFile* source = nullptr;
    bool legacy = false;       ///< the file is older than version 2
    bool in_emitter = false;   ///< spectra are emission, not reflectance
    bool in_quantity = false;  ///< in an object for a quantity that may exceed 1
    int include_depth = 0;
};

/// Names of attributes that an element must have and may have.
struct AcceptedAttributes {
    std::vector<std::string> required, optional;
};

struct Tag {
    XmlElement element;
    std::string_view name;
    const SourceFile* source = nullptr;
    std::vector<XmlAttribute> attributes;
    bool complete = true;  ///< all parameters in the attributes could be replaced

    /// Empty if there is no such attribute.
    std::string_view value(std::string_view attribute) const;
    bool has(std::string_view attribute) const;
    /// Place of the element, or of the value of an attribute.
    Location where() const { return {source, element.offset()}; }
    Location where(std::string_view attribute) const;
};

/// An attribute whose parameters cannot be replaced is reported and becomes empty.
Tag read_tag(XmlElement element, const ReadContext& context, Definitions& definitions);

/// Reports unknown and missing attributes; true if there are none.
bool check_attributes(const Tag& tag, const AcceptedAttributes& accepted, Diagnostics& diagnostics);

}  // namespace lucerna
