// SPDX-License-Identifier: Apache-2.0
#include "core/description/xml_document.h"

#include "core/description/values.h"
#include "core/description/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

namespace lucerna {

namespace {

void report_mismatch(const SourceFile& source, std::size_t at, Diagnostics& diagnostics) {
    const std::string_view text = source.text;
    // pugixml stops behind the "</" of a wrong end tag, or at the end of the text.
    const bool at_tag = at >= 2 && text.substr(at - 2).starts_with("</");
    const std::size_t end = at_tag ? at - 2 : std::string_view::npos;
    const std::size_t open = open_element(text, std::min(end, text.size()));
    if (open == std::string_view::npos) {
        diagnostics.error({&source, std::min(end, at)}, "this end tag has no beginning");
        return;
    }
    const std::string_view name = name_at(text, open + 1);
    if (end == std::string_view::npos) {
        diagnostics.error({&source, open},
                          fmt::format("<{0}> is never ended: </{0}> is missing", name));
        return;
    }
    diagnostics.error(
        {&source, end},
        fmt::format(
            "</{}> cannot end <{}>, which began in line {}", name_at(text, end + 2), name,
            1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(open), '\n')));
}

void report_parse_error(const SourceFile& source, pugi::xml_parse_status status, std::size_t at,
                        Diagnostics& diagnostics) {
    const auto from = [&](std::string_view markup) {
        const std::size_t start = source.text.rfind(markup, at);
        return Location{&source, start == std::string::npos ? at : start};
    };
    switch (status) {
        case pugi::status_end_element_mismatch:
            return report_mismatch(source, at, diagnostics);
        case pugi::status_bad_pi:
            return diagnostics.error(from("<?"), "this <? does not end");
        case pugi::status_bad_comment:
            return diagnostics.error(from("<!--"), "this comment does not end: --> is missing");
        case pugi::status_bad_cdata:
            return diagnostics.error(from("<![CDATA["), "CDATA is not accepted");
        case pugi::status_bad_doctype:
            return diagnostics.error(from("<!"), "DOCTYPE is not accepted");
        case pugi::status_unrecognized_tag:
            return diagnostics.error({&source, at}, "expected the name of an element after \"<\"");
        case pugi::status_bad_start_element:
        case pugi::status_bad_attribute:
            return diagnostics.error({&source, at},
                                     "expected name=\"value\" or \">\" here: a quotation mark is "
                                     "missing before, or the end of an element");
        case pugi::status_out_of_memory:
            return diagnostics.error({&source, 0}, "the file does not fit into memory");
        default:
            return diagnostics.error({&source, at}, "this is not XML");
    }
}

/// Walks over all nodes without recursion and reports what is not a plain tree of elements.
class Checker {
public:
    Checker(const SourceFile& source, const ReadLimits& limits, std::size_t& elements,
            Diagnostics& diagnostics)
        : source_(source),
          limits_(limits),
          elements_(elements),
          diagnostics_(diagnostics),
          has_entities_(source.text.find('&') != std::string::npos) {}

    /// The root element; null if there is none that can be walked.
    pugi::xml_node check(const pugi::xml_document& document) {
        pugi::xml_node root;
        for (const pugi::xml_node top : document.children()) {
            if (top.type() != pugi::node_element) {
                check_other(top);
            } else if (root) {
                error(top, "a second root element; a file has one");
                return {};
            } else {
                root = top;
                if (!check_tree(root)) return {};
            }
        }
        if (!root) diagnostics_.error({&source_, 0}, "the file has no element");
        return root;
    }

private:
    bool check_tree(pugi::xml_node root) {
        int depth = 0;
        for (pugi::xml_node node = root; node;) {
            if (diagnostics_.error_count() >= limits_.max_errors) return false;
            if (depth >= limits_.max_depth) {
                error(node, fmt::format("elements are nested deeper than {}", limits_.max_depth));
                return false;
            }
            if (node.type() != pugi::node_element) {
                check_other(node);
            } else if (++elements_ > limits_.max_elements) {
                error(node, fmt::format("more than {} elements", limits_.max_elements));
                return false;
            } else if (!check_attributes(node)) {
                return false;
            }
            if (node.first_child()) {
                node = node.first_child();
                ++depth;
                continue;
            }
            while (node != root && !node.next_sibling()) {
                node = node.parent();
                --depth;
            }
            node = node == root ? pugi::xml_node() : node.next_sibling();
        }
        return true;
    }

    /// False if there are so many that it is not worth looking at them.
    bool check_attributes(pugi::xml_node element) {
        int count = 0;
        bool look_closer = has_entities_;
        for (const pugi::xml_attribute a : element.attributes()) {
            if (++count > max_attributes) {
                error(element, "too many attributes");
                return false;
            }
            for (pugi::xml_attribute b = a.previous_attribute(); b; b = b.previous_attribute()) {
                if (std::string_view(a.name()) != b.name()) continue;
                error(element, fmt::format("attribute {} is given twice", quote(a.name())));
            }
            look_closer = look_closer || std::string_view(a.value()).find('<') != std::string::npos;
        }
        if (look_closer) check_values(element);
        return true;
    }

    void check_values(pugi::xml_node element) {
        std::size_t position = after_name(source_.text, offset(element));
        for (RawAttribute attribute; next_attribute(source_.text, position, attribute);) {
            std::size_t at = 0;
            const std::string message = value_error(attribute.value, at);
            if (!message.empty()) diagnostics_.error({&source_, attribute.offset + at}, message);
        }
    }

    void check_other(pugi::xml_node node) {
        const std::string_view value = node.value();
        switch (node.type()) {
            case pugi::node_declaration: {
                const std::string_view encoding = node.attribute("encoding").as_string("utf-8");
                if (encoding == "utf-8" || encoding == "UTF-8" || encoding == "utf8") return;
                return error(node, fmt::format("the file says that it is {}; save it as UTF-8",
                                               quote(encoding)));
            }
            case pugi::node_doctype:
                return error(node, "DOCTYPE is not accepted");
            case pugi::node_cdata:
                return error(node, "CDATA is not accepted");
            default:
                break;
        }
        const std::size_t start = std::min(value.find_first_not_of(" \t\r\n"), value.size());
        const std::size_t at = static_cast<std::size_t>(node.offset_debug()) + start;
        diagnostics_.error({&source_, at},
                           fmt::format("text between elements{}; values belong into attributes",
                                       source_.is_shown ? ": " + quote(trimmed(value)) : ""));
    }

    /// Offset of the '<' before a name or a value.
    std::size_t offset(pugi::xml_node node) const {
        const std::ptrdiff_t inside = node.offset_debug();
        return inside > 0 ? source_.text.rfind('<', static_cast<std::size_t>(inside) - 1) : 0;
    }
    void error(pugi::xml_node node, std::string message) {
        diagnostics_.error({&source_, offset(node)}, std::move(message));
    }

    static constexpr int max_attributes = 32;
    const SourceFile& source_;
    const ReadLimits& limits_;
    std::size_t& elements_;
    Diagnostics& diagnostics_;
    bool has_entities_;
};

}  // namespace

std::string_view XmlElement::name() const { return pugi::xml_node(node_).name(); }

std::size_t XmlElement::offset() const {
    const std::ptrdiff_t name = pugi::xml_node(node_).offset_debug();
    return name > 0 ? static_cast<std::size_t>(name) - 1 : 0;
}

std::vector<XmlAttribute> XmlElement::attributes() const {
    std::vector<XmlAttribute> result;
    for (const pugi::xml_attribute attribute : pugi::xml_node(node_).attributes()) {
        if (result.empty()) result.reserve(4);
        result.push_back({attribute.name(), attribute.value()});
    }
    return result;
}

namespace {

XmlElement element_from(pugi::xml_node node) {
    while (node && node.type() != pugi::node_element) node = node.next_sibling();
    return XmlElement(node.internal_object());
}

}  // namespace

XmlElement XmlElement::first_child() const {
    return element_from(pugi::xml_node(node_).first_child());
}

XmlElement XmlElement::next_sibling() const {
    return element_from(pugi::xml_node(node_).next_sibling());
}

XmlDocument::XmlDocument(const SourceFile& source, const ReadLimits& limits, std::size_t& elements,
                         Diagnostics& diagnostics)
    : document_(std::make_unique<pugi::xml_document>()) {
    if (!check_encoding(source, diagnostics)) return;
    constexpr unsigned flags =
        pugi::parse_default | pugi::parse_declaration | pugi::parse_doctype | pugi::parse_fragment;
    const pugi::xml_parse_result result =
        document_->load_buffer(source.text.data(), source.text.size(), flags, pugi::encoding_utf8);
    if (!result) {
        const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0));
        report_parse_error(source, result.status, at, diagnostics);
        return;
    }
    Checker checker(source, limits, elements, diagnostics);
    root_ = XmlElement(checker.check(*document_).internal_object());
}

XmlDocument::~XmlDocument() = default;

}  // namespace lucerna
