// SPDX-License-Identifier: Apache-2.0
#include "core/description/xml_text.h"

#include "core/description/values.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <vector>

namespace lucerna {

namespace {

constexpr std::string_view space = " \t\r\n";

/// Length of the UTF-8 sequence at the front of the text, 0 if there is none (Unicode 15, table
/// 3-7; of the control characters XML allows tab and line ends only).
std::size_t utf8_length(std::string_view text) {
    const auto byte = [&](std::size_t i) -> unsigned {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
    };
    const auto continues = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
    const unsigned b0 = byte(0), b1 = byte(1);
    if (b0 < 0x20) return b0 == '\t' || b0 == '\n' || b0 == '\r' ? 1 : 0;
    if (b0 < 0x80) return 1;
    if (b0 < 0xc2 || b0 > 0xf4 || !continues(1)) return 0;
    if (b0 < 0xe0) return 2;
    if ((b0 == 0xe0 && b1 < 0xa0) || (b0 == 0xed && b1 > 0x9f) || !continues(2)) return 0;
    if (b0 < 0xf0) return 3;
    if ((b0 == 0xf0 && b1 < 0x90) || (b0 == 0xf4 && b1 > 0x8f) || !continues(3)) return 0;
    return 4;
}

/// What ends a piece of markup that is no element: comments, instructions, CDATA. Empty for others.
std::string_view end_of_markup(std::string_view markup) {
    if (markup.starts_with("<!--")) return "-->";
    if (markup.starts_with("<![CDATA[")) return "]]>";
    return markup.starts_with("<?") ? "?>" : "";
}

/// True for a character that XML allows: "#65" or "#x41", what stands between & and ;
bool is_character(std::string_view reference) {
    const bool hexadecimal = reference.starts_with("#x");
    reference.remove_prefix(hexadecimal ? 2 : 1);
    std::uint32_t code = 0;
    const char* const end = reference.data() + reference.size();
    const auto [stop, status] = std::from_chars(reference.data(), end, code, hexadecimal ? 16 : 10);
    const bool control = code < 0x20 && code != '\t' && code != '\n' && code != '\r';
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    return status == std::errc() && stop == end && !control && !surrogate && code <= 0x10ffff;
}

}  // namespace

bool check_encoding(const SourceFile& source, Diagnostics& diagnostics) {
    const std::string_view text = source.text;
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
        text.starts_with(std::string_view("\0<", 2)) ||
        text.starts_with(std::string_view("<\0", 2))) {
        diagnostics.error({&source, 0}, "the file is UTF-16 or UTF-32; save it as UTF-8");
        return false;
    }
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_length(text.substr(i));
        if (length == 0) {
            const unsigned byte = static_cast<unsigned char>(text[i]);
            diagnostics.error(
                {&source, i},
                byte < 0x20
                    ? fmt::format("control character 0x{:02x} in the text", byte)
                    : fmt::format("byte 0x{:02x} is not UTF-8; save the file as UTF-8", byte));
            return false;
        }
        i += length;
    }
    return true;
}

std::size_t open_element(std::string_view text, std::size_t end) {
    std::vector<std::size_t> open;
    for (std::size_t at = text.find('<'); at < end;) {
        const std::string_view closing = end_of_markup(text.substr(at));
        std::size_t stop = text.find(closing, at);
        if (closing.empty()) {
            bool in_quotes = false;
            char quote_mark = '"';
            for (stop = at; stop < end && (in_quotes || text[stop] != '>'); ++stop) {
                if (!in_quotes && (text[stop] == '"' || text[stop] == '\''))
                    quote_mark = text[stop];
                if (text[stop] == quote_mark) in_quotes = !in_quotes;
            }
            if (text.substr(at + 1).starts_with('/')) {
                if (!open.empty()) open.pop_back();
            } else if (stop < end && text[stop - 1] != '/') {
                open.push_back(at);
            }
        }
        at = text.find('<', std::min(stop, end));
    }
    return open.empty() ? std::string_view::npos : open.back();
}

std::string_view name_at(std::string_view text, std::size_t start) {
    return text.substr(start, text.find_first_of(" \t\r\n/>", start) - start);
}

std::size_t after_name(std::string_view text, std::size_t element_offset) {
    const std::size_t end = text.find_first_of(" \t\r\n/>", element_offset + 1);
    return std::min(end, text.size());
}

bool next_attribute(std::string_view text, std::size_t& position, RawAttribute& attribute) {
    const std::size_t name = text.find_first_not_of(space, position);
    if (name == std::string_view::npos || text[name] == '>' || text[name] == '/') return false;
    const std::size_t equals = text.find('=', name);
    if (equals == std::string_view::npos) return false;
    const std::size_t quote = text.find_first_of("\"'", equals);
    if (quote == std::string_view::npos) return false;
    const std::size_t end = text.find(text[quote], quote + 1);
    if (end == std::string_view::npos) return false;
    attribute = {trimmed(text.substr(name, equals - name)), quote + 1,
                 text.substr(quote + 1, end - quote - 1)};
    position = end + 1;
    return true;
}

std::string value_error(std::string_view raw, std::size_t& at) {
    for (at = 0; at < raw.size(); ++at) {
        if (raw[at] == '<') return "\"<\" in a value: a quotation mark is missing, or write &lt;";
        if (raw[at] != '&') continue;
        const std::string_view rest = raw.substr(at + 1);
        const std::size_t end = rest.find_first_of("; &<");
        if (end == std::string_view::npos || rest[end] != ';') {
            return "\"&\" in a value: write &amp;";
        }
        const std::string_view name = rest.substr(0, end);
        const bool known = name == "lt" || name == "gt" || name == "amp" || name == "quot" ||
                           name == "apos" || (name.starts_with('#') && is_character(name));
        if (!known) return fmt::format("unknown entity {}", quote(fmt::format("&{};", name)));
    }
    return {};
}

std::size_t attribute_value_offset(std::string_view text, std::size_t element_offset,
                                   std::string_view attribute) {
    std::size_t position = after_name(text, element_offset);
    for (RawAttribute found; next_attribute(text, position, found);) {
        if (found.name == attribute) return found.offset;
    }
    return element_offset;
}

}  // namespace lucerna
