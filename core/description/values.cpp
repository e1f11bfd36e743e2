// SPDX-License-Identifier: Apache-2.0
#include "core/description/values.h"

#include <fmt/format.h>

#include <charconv>

namespace lucerna {

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view space = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(space);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(space) - begin + 1);
}

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

/// Reads numbers and separators from the front of a text.
class Scanner {
public:
    explicit Scanner(std::string_view text) : text_(text), rest_(trimmed(text)) {}

    bool done() const { return rest_.empty(); }

    double number() {
        std::string_view digits = rest_;
        const bool plus = digits.size() > 1 && digits[0] == '+' && digits[1] != '-';
        if (plus) digits.remove_prefix(1);  // which from_chars does not know
        double value = 0;
        const char* const end = digits.data() + digits.size();
        const auto [stop, status] = std::from_chars(digits.data(), end, value);
        if (status == std::errc::invalid_argument) {
            throw Error(fmt::format("expected a number, not {}", quote(text_)));
        }
        const std::string_view token(digits.data(), static_cast<std::size_t>(stop - digits.data()));
        if (status == std::errc::result_out_of_range) {
            throw Error(fmt::format("the number {} is too large or too small", quote(token)));
        }
        if (!std::isfinite(value)) {
            throw Error(fmt::format("expected a finite number, not {}", quote(token)));
        }
        if (std::abs(value) > double{std::numeric_limits<float>::max()}) {
            throw Error(fmt::format("the number {} is too large", quote(token)));
        }
        rest_ = std::string_view(stop, static_cast<std::size_t>(end - stop));
        return value;
    }

    /// White space, or one comma with white space around it. False if nothing follows.
    bool separator() {
        const std::size_t before = rest_.size();
        skip_space();
        if (skip(',')) skip_space();
        if (rest_.size() == before) {
            throw Error(fmt::format("expected a space or a comma before \"{}\" in {}",
                                    rest_.substr(0, 1), quote(text_)));
        }
        return !done();
    }

    void colon() {
        skip_space();
        if (!skip(':')) {
            throw Error(fmt::format("expected wavelength:value pairs, not {}", quote(text_)));
        }
        skip_space();
    }

private:
    void skip_space() {
        while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    }
    bool skip(char c) {
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }

    std::string_view text_, rest_;
};

/// "1,5" as it is written in half of the world.
bool has_decimal_comma(std::string_view text) {
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos || comma == 0 || comma + 1 == text.size()) return false;
    return text.find_first_not_of("0123456789+-,") == std::string_view::npos &&
           text.find(',', comma + 1) == std::string_view::npos;
}

/// IEC 61966-2-1.
ColorD linear_from_srgb(ColorD encoded) {
    ColorD linear;
    for (int i = 0; i < 3; ++i) {
        const double v = encoded[i];
        linear[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return linear;
}

ColorD parse_hex(std::string_view text) {
    ColorD color;
    bool valid = text.size() == 7;
    for (int i = 0; valid && i < 3; ++i) {
        const char* const digits = text.data() + 1 + 2 * i;
        unsigned value = 0;
        const auto [stop, status] = std::from_chars(digits, digits + 2, value, 16);
        valid = status == std::errc() && stop == digits + 2;
        color[i] = value / 255.0;
    }
    if (!valid) throw Error(fmt::format("expected a colour like \"#c08040\", not {}", quote(text)));
    return color;
}

ColorD parse_channels(std::string_view text) {
    const std::vector<double> channels = parse_numbers(text);
    if (channels.size() == 1) return ColorD(channels[0]);
    if (channels.size() == 3) return {channels[0], channels[1], channels[2]};
    throw Error(fmt::format("expected one or three numbers, not the {} of {}", channels.size(),
                            quote(text)));
}

}  // namespace

bool parse_boolean(std::string_view text) {
    std::string word(trimmed(text).substr(0, 6));
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (word != "true" && word != "false") {
        throw Error(fmt::format("expected true or false, not {}", quote(text)));
    }
    return word == "true";
}

std::int64_t parse_integer(std::string_view text) {
    std::string_view digits = trimmed(text);
    if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
    std::int64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, status] = std::from_chars(digits.data(), end, value);
    if (status == std::errc::result_out_of_range && stop == end) {
        throw Error(fmt::format("the integer {} does not fit into 64 bits", quote(text)));
    }
    if (status != std::errc() || stop != end) {
        throw Error(fmt::format("expected an integer, not {}", quote(text)));
    }
    return value;
}

double parse_float(std::string_view text) {
    Scanner scanner(text);
    const double value = scanner.number();
    if (!scanner.done()) {
        std::string hint;
        if (has_decimal_comma(trimmed(text))) hint = "; the decimal separator is a point";
        throw Error(fmt::format("expected a number, not {}{}", quote(text), hint));
    }
    if (value != 0 && std::abs(value) < double{std::numeric_limits<float>::denorm_min()}) {
        throw Error(
            fmt::format("the number {} is too small; write 0 if that is meant", quote(text)));
    }
    return value;
}

std::vector<double> parse_numbers(std::string_view text) {
    std::vector<double> numbers;
    for (Scanner scanner(text); numbers.empty() || !scanner.done();) {
        if (!numbers.empty() && !scanner.separator()) break;
        numbers.push_back(scanner.number());
    }
    return numbers;
}

Vector3d parse_triple(std::string_view text) {
    const std::vector<double> n = parse_numbers(text);
    if (n.size() != 3) {
        throw Error(fmt::format("expected three numbers, not the {} of {}", n.size(), quote(text)));
    }
    return {n[0], n[1], n[2]};
}

ColorD parse_rgb(std::string_view text) {
    const std::string_view word = trimmed(text);
    if (word.starts_with('#')) return linear_from_srgb(parse_hex(word));
    return parse_channels(text);
}

ColorD parse_linear_rgb(std::string_view text) {
    const std::string_view word = trimmed(text);
    return word.starts_with('#') ? parse_hex(word) : parse_channels(text);
}

ColorD parse_srgb(std::string_view text) {
    const std::string_view word = trimmed(text);
    return linear_from_srgb(word.starts_with('#') ? parse_hex(word) : parse_channels(text));
}

Matrix4d parse_matrix(std::string_view text) {
    const std::vector<double> n = parse_numbers(text);
    if (n.size() != 16 && n.size() != 9) {
        throw Error(fmt::format("expected 16 or 9 numbers, not {}", n.size()));
    }
    const int size = n.size() == 16 ? 4 : 3;
    Matrix4d matrix(1.0);
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
            matrix[column][row] = n[static_cast<std::size_t>(row * size + column)];
        }
    }
    return matrix;
}

Spectrum parse_spectrum_list(std::string_view text) {
    Spectrum spectrum;
    for (Scanner scanner(text); spectrum.values.empty() || !scanner.done();) {
        if (!spectrum.values.empty() && !scanner.separator()) break;
        spectrum.wavelengths.push_back(scanner.number());
        scanner.colon();
        spectrum.values.push_back(scanner.number());
    }
    return spectrum;
}

}  // namespace lucerna
