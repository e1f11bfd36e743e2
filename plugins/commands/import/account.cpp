// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/account.h"

#include <fmt/format.h>

#include <algorithm>

namespace lucerna {

void Account::note(Fate fate, const std::string& kind, const std::string& name,
                   const std::string& remark) {
    const Line line{fate, kind, name, remark};
    if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(line);
}

std::string Account::table() const {
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

const char* Account::word(Fate fate) {
    constexpr const char* words[] = {"converted", "approximated", "dropped", "added"};
    return words[static_cast<int>(fate)];
}

}  // namespace lucerna
