// SPDX-License-Identifier: Apache-2.0
/// What became of the things in a model: the table that `lucerna import` prints.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace lucerna {

enum class Fate { converted, approximated, dropped, added };

class Account {
public:
    void note(Fate fate, const std::string& kind, const std::string& name,
              const std::string& remark = "") {
        const Line line{fate, kind, name, remark};
        if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(line);
    }

    /// A line for each thing, those that are as they were first.
    std::string table() const {
        std::vector<Line> sorted = lines_;
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const Line& a, const Line& b) { return a.fate < b.fate; });
        std::size_t kind = 0, name = 0;
        for (const Line& line : sorted) {
            kind = std::max(kind, line.kind.size());
            name = std::max(name, std::min<std::size_t>(line.name.size(), 32));
        }
        std::string text;
        for (const Line& line : sorted) {
            std::string row = fmt::format("{:<12}  {:<{}}  {:<{}}  {}", word(line.fate), line.kind,
                                          kind, line.name, name, line.remark);
            row.erase(row.find_last_not_of(' ') + 1);
            text += row + "\n";
        }
        return text;
    }

private:
    struct Line {
        Fate fate;
        std::string kind, name, remark;
        bool operator==(const Line&) const = default;
    };

    static const char* word(Fate fate) {
        constexpr const char* words[] = {"converted", "approximated", "dropped", "added"};
        return words[static_cast<int>(fate)];
    }

    std::vector<Line> lines_;
};

}  // namespace lucerna
