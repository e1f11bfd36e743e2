// SPDX-License-Identifier: Apache-2.0
/// Parameters of a scene: `<default name="spp" value="64"/>`, `-D spp=256`, and `$spp` or `${spp}`
/// in any value.
#pragma once

#include "core/description/description.h"

#include <map>
#include <optional>
#include <utility>

namespace lucerna {

class Definitions {
public:
    /// Those of the command line; the last of equal names counts. Their places are added to
    /// `description`. What expansion may produce in sum is bounded by `max_bytes`.
    Definitions(const std::vector<std::pair<std::string, std::string>>& command_line,
                std::size_t max_bytes, Description& description, Diagnostics& diagnostics);

    /// Counts unless the name has a value already.
    void set_default(std::string_view name, std::string_view value, Location where);

    /// The value with every `$name` replaced; valid as long as this object and `value`. Empty if it
    /// cannot be done, which is reported.
    std::optional<std::string_view> expand(std::string_view value, Location where);

    /// An error for each definition of the command line that changed nothing.
    void report_unused() const;

private:
    struct Definition {
        std::string value;
        Location where;
        bool from_command_line = false;
        bool used = false;
    };
    bool append_expanded(std::string_view value, Location where, std::string& result);
    std::vector<std::string> names_in_scene() const;

    std::map<std::string, Definition, std::less<>> definitions_;
    std::map<std::string, Location, std::less<>> defaults_;
    std::deque<std::string> expanded_;
    std::size_t bytes_left_;
    Diagnostics& diagnostics_;
};

}  // namespace lucerna
