// SPDX-License-Identifier: Apache-2.0
/// Where a preview is shown, as the command line says it.
#pragma once

#include "core/base/error.h"

#include <fmt/format.h>

#include <charconv>
#include <string>
#include <string_view>

namespace lucerna {

struct Place {
    std::string host;
    int port = 0;

    /// "127.0.0.1:14158", "[::1]:14158"
    std::string text() const {
        const bool ipv6 = host.find(':') != std::string::npos;
        return fmt::format(fmt::runtime(ipv6 ? "[{}]:{}" : "{}:{}"), host, port);
    }
};

/// A number from 1 to 65535. Throws Error.
inline int parse_port(std::string_view text) {
    int port = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), port);
    const bool number = problem == std::errc() && end == text.data() + text.size();
    if (!number || port < 1 || port > 65535) {
        throw Error(fmt::format("{} is no port; expected a number from 1 to 65535", quote(text)));
    }
    return port;
}

/// "", "PORT", "HOST" or "HOST:PORT"; an IPv6 address with a port is in brackets. What is not given
/// stays as in `otherwise`. Throws Error.
inline Place parse_place(std::string_view text, Place otherwise) {
    Place place = std::move(otherwise);
    if (text.empty()) return place;
    if (text.find_first_not_of("0123456789") == std::string_view::npos) {
        place.port = parse_port(text);
        return place;
    }
    const bool brackets = text.front() == '[';
    const std::size_t end = brackets ? text.find(']') : text.find(':');
    place.host = text.substr(brackets ? 1 : 0, end == text.npos ? end : end - (brackets ? 1 : 0));
    if (place.host.empty() || (brackets && end == text.npos)) {
        throw Error(fmt::format("{} is no address; expected HOST:PORT", quote(text)));
    }
    if (end == text.npos) return place;
    text.remove_prefix(end + (brackets ? 1 : 0));
    if (text.empty()) return place;
    if (text.front() != ':') {
        throw Error(fmt::format("{} is no port; expected a colon and a number", quote(text)));
    }
    place.port = parse_port(text.substr(1));
    return place;
}

}  // namespace lucerna
