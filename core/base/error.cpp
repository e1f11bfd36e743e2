// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace lucerna {

Error::~Error() = default;
PluginError::~PluginError() = default;
FileError::~FileError() = default;
TransientFileError::~TransientFileError() = default;
SceneError::~SceneError() = default;

namespace {

/// Distance that counts insertions, deletions, substitutions and swaps of neighbours
/// (optimal string alignment; Damerau 1964).
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, substitution});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

/// The line around `offset` with a caret below the column; long lines are cut around the caret.
std::string make_excerpt(std::string_view line, std::size_t column) {
    constexpr std::size_t width = 100;
    std::string_view shown = line;
    std::size_t caret = column;
    if (line.size() > width && column > width / 2) {
        const std::size_t cut = std::min(column - width / 2, line.size() - width);
        shown.remove_prefix(cut);
        caret -= cut;
    }
    shown = shown.substr(0, width);
    std::string text, below;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const bool printable = static_cast<unsigned char>(shown[i]) >= 0x20;
        text += printable || shown[i] == '\t' ? shown[i] : '?';
        if (i < caret) below += shown[i] == '\t' ? '\t' : ' ';
    }
    return fmt::format("  {}\n  {}^", text, below);
}

/// The longest part of the text that ends at `end` at most and between two characters of UTF-8.
std::string_view head_of(std::string_view text, std::size_t end) {
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
    return text.substr(0, end);
}

/// The text with lines of a length that can be read: a name may be as long as a file.
std::string with_short_lines(std::string_view text) {
    constexpr std::size_t longest = 1000, head = 300, tail = 600;
    std::string result;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, std::min(text.find('\n'), text.size()));
        if (line.size() <= longest) {
            result += line;
        } else {
            std::size_t rest = line.size() - tail;
            while (rest < line.size() && (static_cast<unsigned char>(line[rest]) & 0xc0) == 0x80) {
                ++rest;
            }
            result += head_of(line, head);
            result += " ... ";
            result += line.substr(rest);
        }
        text.remove_prefix(line.size());
        if (text.starts_with('\n')) {
            result += '\n';
            text.remove_prefix(1);
        }
    }
    return result;
}

}  // namespace

std::string quote(std::string_view text) {
    constexpr std::size_t limit = 60;
    if (text.size() <= limit) return fmt::format("\"{}\"", text);
    return fmt::format("\"{}...\"", head_of(text, limit));
}

std::string Diagnostic::text() const {
    const char* level = severity == Severity::error ? "error" : "warning";
    std::string place;
    if (!file.empty())
        place = line > 0 ? fmt::format("{}:{}:{}: ", file, line, column) : file + ": ";
    std::string result = fmt::format("{}{}: {}", place, level, message);
    if (!excerpt.empty()) result += "\n" + excerpt;
    return result;
}

void Diagnostics::add(Severity severity, Location where, std::string_view message) {
    Diagnostic diagnostic;
    diagnostic.severity = severity;
    diagnostic.message = with_short_lines(message);
    if (where.file) {
        diagnostic.file = where.file->path;
        diagnostic.line = diagnostic.column = 1;  // of an empty file
        const std::string_view text = where.file->text;
        if (!text.empty()) {
            const std::size_t offset = std::min(where.offset, text.size() - 1);
            const std::string_view head = text.substr(0, offset);
            const std::size_t newline = head.rfind('\n');
            const std::size_t start = newline == std::string_view::npos ? 0 : newline + 1;
            const std::size_t end = std::min(text.find('\n', start), text.size());
            diagnostic.line = 1 + static_cast<int>(std::count(head.begin(), head.end(), '\n'));
            diagnostic.column = 1 + static_cast<int>(offset - start);
            if (where.file->is_shown) {
                diagnostic.excerpt = make_excerpt(text.substr(start, end - start), offset - start);
            }
        }
    }
    error_count_ += severity == Severity::error ? 1 : 0;
    all_.push_back(std::move(diagnostic));
}

void Diagnostics::error(Location where, std::string_view message) {
    add(Severity::error, where, message);
}

void Diagnostics::warning(Location where, std::string_view message) {
    add(Severity::warning, where, message);
}

void Diagnostics::plugin_error(Location where, std::string_view message) {
    plugin_failed_ = true;
    const bool known = std::any_of(all_.begin(), all_.end(),
                                   [&](const Diagnostic& d) { return d.message == message; });
    if (known) return;
    add(Severity::error, where, message);
}

namespace {

/// Each message once, by its place: files in the order in which they are first spoken of.
std::vector<Diagnostic> in_order(std::vector<Diagnostic> all) {
    std::map<std::string, std::size_t> ranks;
    for (const Diagnostic& d : all) ranks.try_emplace(d.file, ranks.size());
    const auto place = [&](const Diagnostic& d) {
        return std::tuple(ranks.at(d.file), d.line, d.column);
    };
    std::stable_sort(all.begin(), all.end(),
                     [&](const Diagnostic& a, const Diagnostic& b) { return place(a) < place(b); });
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::string text_of(const std::vector<Diagnostic>& diagnostics) {
    std::string text;
    for (const Diagnostic& d : diagnostics) {
        if (!text.empty()) text += '\n';
        text += d.text();
    }
    return text;
}

}  // namespace

void Diagnostics::throw_if_errors() const {
    if (error_count_ == 0) return;
    if (plugin_failed_) throw PluginError(text_of(in_order(all_)));
    throw SceneError(in_order(all_));
}

SceneError::SceneError(std::vector<Diagnostic> diagnostics)
    : Error(text_of(diagnostics)), diagnostics_(std::move(diagnostics)) {}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t longest = 100;  // the distance takes time with the square of the length
    if (word.size() > longest) return "";
    std::string best;
    std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string best = nearest(word, candidates);
    return best.empty() ? "" : fmt::format("; did you mean \"{}\"?", best);
}

std::string join(const std::vector<std::string>& words, std::string_view separator) {
    return fmt::format("{}", fmt::join(words, separator));
}

}  // namespace lucerna
