// SPDX-License-Identifier: Apache-2.0
#include "core/description/tag.h"

#include "core/description/legacy.h"
#include "core/description/values.h"
#include "core/description/xml_text.h"

#include <fmt/format.h>

namespace lucerna {

std::string_view Tag::value(std::string_view attribute) const {
    for (const XmlAttribute& a : attributes) {
        if (a.name == attribute) return a.value;
    }
    return {};
}

bool Tag::has(std::string_view attribute) const {
    return std::any_of(attributes.begin(), attributes.end(),
                       [&](const XmlAttribute& a) { return a.name == attribute; });
}

Location Tag::where(std::string_view attribute) const {
    return {source, attribute_value_offset(source->text, element.offset(), attribute)};
}

Tag read_tag(XmlElement element, const ReadContext& context, Definitions& definitions) {
    Tag tag{element, element.name(), context.source, element.attributes(), true};
    if (context.legacy) tag.name = legacy_tag(tag.name);
    for (XmlAttribute& attribute : tag.attributes) {
        if (attribute.value.find('$') == std::string_view::npos) continue;
        const auto expanded = definitions.expand(attribute.value, tag.where(attribute.name));
        tag.complete = tag.complete && expanded;
        attribute.value = expanded.value_or("");
    }
    return tag;
}

bool check_attributes(const Tag& tag, const AcceptedAttributes& accepted,
                      Diagnostics& diagnostics) {
    const auto contains = [](const std::vector<std::string>& names, std::string_view name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    bool valid = true;
    for (const XmlAttribute& attribute : tag.attributes) {
        if (contains(accepted.required, attribute.name)) continue;
        if (contains(accepted.optional, attribute.name)) continue;
        std::vector<std::string> names = accepted.required;
        names.insert(names.end(), accepted.optional.begin(), accepted.optional.end());
        diagnostics.error(
            tag.where(attribute.name),
            fmt::format("<{}> has no attribute {}; it takes {}{}", tag.name, quote(attribute.name),
                        join(names), did_you_mean(attribute.name, names)));
        valid = false;
    }
    for (const std::string& name : accepted.required) {
        if (tag.has(name) || !valid) continue;  // a misspelt name is one error, not two
        diagnostics.error(tag.where(),
                          fmt::format("<{}> needs the attribute \"{}\"", tag.name, name));
        valid = false;
    }
    return valid;
}

}  // namespace lucerna
