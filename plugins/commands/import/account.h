// SPDX-License-Identifier: Apache-2.0
/// What became of the things in a model: the table that `lucerna import` prints.
#pragma once

#include <string>
#include <vector>

namespace lucerna {

enum class Fate { converted, approximated, dropped, added };

class Account {
public:
    void note(Fate fate, const std::string& kind, const std::string& name,
              const std::string& remark = "");

    /// A line for each thing, those that are as they were first.
    std::string table() const;

private:
    struct Line {
        Fate fate;
        std::string kind, name, remark;
        bool operator==(const Line&) const = default;
    };

    static const char* word(Fate fate);

    std::vector<Line> lines_;
};

}  // namespace lucerna
