// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/compare/page.h"

#include "plugins/commands/compare/picture_text.h"

#include <string_view>

namespace lucerna {

/// The page without data, made by report/embed.cmake.
extern const unsigned char report_page[];
extern const std::size_t report_page_size;

namespace {

/// A block of data that no browser runs. In JSON, "<" can stand in strings only.
std::string data_block(const std::string& id, const std::string& type, const std::string& content) {
    std::string escaped;
    escaped.reserve(content.size());
    for (const char c : content) escaped += c == '<' ? std::string("\\u003c") : std::string(1, c);
    return "<script type=\"" + type + "\" id=\"" + id + "\">" + escaped + "</script>\n";
}

}  // namespace

std::string to_html(const ComparisonResult& result, const Json& report) {
    std::string data = data_block("report", "application/json", report.text());
    data += data_block("picture-0", "text/plain", encoded_picture(result.reference.image));
    int number = 0;
    for (const VariantRuns& variant : result.variants) {
        data += data_block("picture-" + std::to_string(++number), "text/plain",
                           encoded_picture(variant.picture));
    }
    std::string page(reinterpret_cast<const char*>(report_page), report_page_size);
    constexpr std::string_view marker = "<!-- data -->";
    return page.replace(page.find(marker), marker.size(), data);
}

}  // namespace lucerna
