// SPDX-License-Identifier: Apache-2.0
/// Walks through a text file in memory, and knows its line when something is wrong. Lines end with
/// a line feed, a carriage return, or both.
#pragma once

#include "core/base/error.h"
#include "core/base/file_bytes.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace lucerna {

class TextCursor {
public:
    /// `name` of the file, for messages.
    TextCursor(std::span<const std::uint8_t> bytes, std::string name, int line = 1)
        : at_(reinterpret_cast<const char*>(bytes.data())),
          end_(at_ + bytes.size()),
          name_(std::move(name)),
          line_(line) {
        if (line == 1) at_ = without_byte_order_mark({at_, remaining()}).data();
    }

    bool at_end() const { return at_ == end_; }
    bool at_line_end() const { return at_ == end_ || *at_ == '\n' || *at_ == '\r'; }
    /// The next byte, or a line feed at the end of the file.
    char peek() const { return at_ == end_ ? '\n' : *at_; }
    std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }

    /// Spaces and tabs, and a backslash at the end of a line, which the next one continues.
    void skip_blanks() {
        for (; at_ != end_; ++at_) {
            if (is_blank(*at_)) continue;
            if (!continues_line()) return;
            at_ += at_[1] == '\r' && end_ - at_ > 2 && at_[2] == '\n' ? 2 : 1;
            ++line_;
        }
    }
    /// Blanks and line ends.
    void skip_space() {
        for (skip_blanks(); at_ != end_ && at_line_end(); skip_blanks()) next_line();
    }
    /// To the start of the next line. Returns what ended this one, which is empty at the end of the
    /// file.
    std::string_view next_line() {
        while (!at_line_end()) ++at_;
        const char* start = at_;
        if (at_ == end_) return {};
        at_ += *at_ == '\r' && end_ - at_ > 1 && at_[1] == '\n' ? 2 : 1;
        ++line_;
        return {start, static_cast<std::size_t>(at_ - start)};
    }
    /// The same in a file whose lines all have this end, so that what follows may be binary.
    void next_line(std::string_view line_end) {
        while (!at_line_end()) ++at_;
        if (std::string_view(at_, remaining()).starts_with(line_end)) {
            at_ += line_end.size();
            ++line_;
        } else {
            next_line();
        }
    }
    bool at_blank() const { return at_line_end() || is_blank(*at_) || continues_line(); }
    bool accept(char c) {
        if (at_ == end_ || *at_ != c) return false;
        ++at_;
        return true;
    }
    /// Up to the next blank or line end; empty at the end of a line.
    std::string_view word() {
        skip_blanks();
        const char* start = at_;
        while (!at_blank()) ++at_;
        return {start, static_cast<std::size_t>(at_ - start)};
    }

    /// A finite number, and nothing else up to the next blank. Throws Error.
    double number(std::string_view what) {
        skip_blanks();
        const char* start = at_;
        double value = 0;
        parse(value, what, "a number");
        if (!at_blank()) {
            at_ = start;
            complain(what, "a number");
        }
        if (!std::isfinite(value)) fail(fmt::format("{} is not finite", what));
        return value;
    }
    /// A whole number; anything may follow. Throws Error.
    std::int64_t integer(std::string_view what) {
        skip_blanks();
        std::int64_t value = 0;
        parse(value, what, "a whole number");
        return value;
    }

    /// "a.obj:3: message"
    std::string at_this_line(std::string_view message) const {
        return fmt::format("{}:{}: {}", name_, line_, message);
    }
    /// Throws Error with file and line.
    [[noreturn]] void fail(std::string_view message) const { throw Error(at_this_line(message)); }

private:
    static bool is_blank(char c) { return c == ' ' || c == '\t'; }

    bool continues_line() const {
        return *at_ == '\\' && end_ - at_ >= 2 && (at_[1] == '\n' || at_[1] == '\r');
    }

    template <typename T>
    void parse(T& value, std::string_view what, std::string_view kind) {
        const char* start = at_;
        if (end_ - at_ >= 2 && *at_ == '+' && at_[1] != '-') ++start;
        const auto [stop, problem] = std::from_chars(start, end_, value);
        if (problem == std::errc()) {
            at_ = stop;
            return;
        }
        complain(what, kind);
    }

    [[noreturn]] void complain(std::string_view what, std::string_view kind) {
        fail(fmt::format("{} should be {}, not \"{}\"", what, kind, word().substr(0, 32)));
    }

    const char* at_;
    const char* end_;
    std::string name_;
    int line_;
};

}  // namespace lucerna
