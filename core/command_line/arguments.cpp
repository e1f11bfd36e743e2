// SPDX-License-Identifier: Apache-2.0
#include "core/command_line/arguments.h"

#include "core/base/error.h"
#include "core/description/values.h"
#include "core/interfaces/command.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>

namespace lucerna {

namespace {

template <typename T>
T in_range(T value, Range range) {
    if (range.contains(static_cast<double>(value))) return value;
    throw Error(fmt::format("{} is not in the range {}", value, range.text()));
}

double parse_double(const std::string& text, Range range) {
    return in_range(parse_float(text), range);
}

/// A negative number never fits: all ranges of such options begin at zero or above.
std::uint64_t parse_unsigned(const std::string& text, Range range) {
    const std::int64_t value = parse_integer(text);
    if (value < 0) throw Error(fmt::format("{} is negative", value));
    return static_cast<std::uint64_t>(in_range(value, range));
}

int parse_int(const std::string& text, Range range) {
    range.min = std::max(range.min, static_cast<double>(std::numeric_limits<int>::min()));
    range.max = std::min(range.max, static_cast<double>(std::numeric_limits<int>::max()));
    return static_cast<int>(in_range(parse_integer(text), range));
}

std::vector<int> parse_list(const std::string& text, char separator, std::size_t count,
                            Range range) {
    std::vector<int> values;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        values.push_back(parse_int(text.substr(begin, end - begin), range));
        begin = end + 1;
    }
    if (values.size() == count) return values;
    throw Error(fmt::format("{} are {} numbers, not {}", quote(text), values.size(), count));
}

constexpr std::size_t help_width = 96, help_indent = 32;

/// Breaks lines at spaces, so that none is longer than `width`.
std::string wrapped(const std::string& text, std::size_t width) {
    std::string result;
    std::size_t column = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
        if (column > 0 && column + 1 + (end - begin) > width) {
            result += '\n';
            column = 0;
        } else if (column > 0) {
            result += ' ';
            ++column;
        }
        result += text.substr(begin, end - begin);
        column += end - begin;
        if (end < text.size() && text[end] == '\n') {
            result += '\n';
            column = 0;
        }
        begin = end + 1;
    }
    return result;
}

std::string wrapped_doc(const std::string& doc) { return wrapped(doc, help_width - help_indent); }

}  // namespace

struct Arguments::State {
    State(const std::string& command, const std::string& summary)
        : app(summary, "lucerna " + command), name(command) {
        app.get_formatter()->column_width(help_indent);
        app.set_help_flag("-h,--help", "print this");
    }

    CLI::App app;
    std::string name;
};

Arguments::Arguments(const std::string& command, const std::string& summary)
    : state_(std::make_unique<State>(command, summary)) {}

Arguments::~Arguments() = default;

void Arguments::add(const std::string& names, const std::string& placeholder,
                    const std::string& doc, bool repeatable, Take take) {
    const std::string name = names.substr(names.rfind(',') + 1);
    const CLI::callback_t callback = [name, repeatable, take](const CLI::results_t& texts) {
        if (texts.size() > 1 && !repeatable) {
            throw CLI::ValidationError(name, "given more than once");
        }
        for (const std::string& text : texts) {
            try {
                take(text);
            } catch (const Error& e) {
                throw CLI::ValidationError(name, e.what());
            }
        }
        return true;
    };
    CLI::Option* option = state_->app.add_option(names, callback, wrapped_doc(doc));
    option->type_name(placeholder)->type_size(1)->expected(1)->take_all();
}

void Arguments::positional(const std::string& name, std::string& value, const std::string& doc,
                           bool optional) {
    state_->app.add_option(name, value, wrapped_doc(doc))->required(!optional)->type_name("");
}

void Arguments::positional(const std::string& name, std::vector<std::string>& values,
                           const std::string& doc) {
    state_->app.add_option(name, values, wrapped_doc(doc))->type_name("");
}

void Arguments::option(const std::string& names, const std::string& placeholder, std::string& value,
                       const std::string& doc) {
    add(names, placeholder, doc, false, [&value](const std::string& text) { value = text; });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::vector<std::string>& values, const std::string& doc) {
    add(names, placeholder, doc, true,
        [&values](const std::string& text) { values.push_back(text); });
}

void Arguments::option(const std::string& names, const std::string& placeholder, double& value,
                       Range range, const std::string& doc) {
    add(names, placeholder, doc, false,
        [&value, range](const std::string& text) { value = parse_double(text, range); });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::optional<double>& value, Range range, const std::string& doc) {
    add(names, placeholder, doc, false,
        [&value, range](const std::string& text) { value = parse_double(text, range); });
}

void Arguments::option(const std::string& names, const std::string& placeholder, int& value,
                       Range range, const std::string& doc) {
    add(names, placeholder, doc, false,
        [&value, range](const std::string& text) { value = parse_int(text, range); });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::uint64_t& value, Range range, const std::string& doc) {
    add(names, placeholder, doc, false,
        [&value, range](const std::string& text) { value = parse_unsigned(text, range); });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::optional<std::uint64_t>& value, Range range, const std::string& doc) {
    add(names, placeholder, doc, false,
        [&value, range](const std::string& text) { value = parse_unsigned(text, range); });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::vector<int>& values, char separator, std::size_t count, Range range,
                       const std::string& doc) {
    add(names, placeholder, doc, false,
        [&values, separator, count, range](const std::string& text) {
            values = parse_list(text, separator, count, range);
        });
}

void Arguments::option(const std::string& names, const std::string& placeholder,
                       std::vector<std::pair<std::string, std::string>>& values,
                       const std::string& doc) {
    add(names, placeholder, doc, true, [&values](const std::string& text) {
        const std::size_t equals = text.find('=');
        if (equals == 0 || equals == std::string::npos) {
            throw Error("expected NAME=VALUE, not " + quote(text));
        }
        values.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    });
}

void Arguments::flag(const std::string& names, bool& value, const std::string& doc) {
    state_->app.add_flag(names, value, wrapped_doc(doc));
}

void Arguments::footer(const std::string& text) { state_->app.footer(wrapped(text, help_width)); }

int Arguments::usage_error(const std::string& message) const {
    fmt::print(stderr, "lucerna {}: {}\n  see `lucerna {} --help`\n", state_->name, message,
               state_->name);
    return exit_code::usage;
}

std::optional<int> Arguments::parse(const std::vector<std::string>& words) {
    // CLI11 takes the words from the back.
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    try {
        state_->app.parse(reversed);
        return {};
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", state_->app.help());
        return exit_code::success;
    } catch (const CLI::ExtrasError&) {
        const std::string word = state_->app.remaining().front();
        if (word.empty() || word[0] != '-') {
            return usage_error("unexpected argument " + quote(word));
        }
        std::vector<std::string> known;
        for (const CLI::Option* option : state_->app.get_options()) {
            for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
        }
        const std::string name = word.substr(0, word.find('='));
        return usage_error("unknown option " + name + did_you_mean(name, known));
    } catch (const CLI::ParseError& e) {
        return usage_error(e.what());
    }
}

std::string shell_text(const std::string& command, const std::vector<std::string>& words) {
    std::string text = "lucerna " + command;
    for (const std::string& word : words) {
        const bool plain = !word.empty() &&
                           word.find_first_of(" \t\n'\"\\$*?[]{}~`#!;&|<>()") == std::string::npos;
        std::string quoted;
        for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
        text += plain ? " " + word : " '" + quoted + "'";
    }
    return text;
}

}  // namespace lucerna
