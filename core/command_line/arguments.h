// SPDX-License-Identifier: Apache-2.0
/// The arguments of a command, declared once: from there come values, their checks, and --help.
/// arguments.cpp is the only user of CLI11.
///
///     Arguments arguments("tonemap", "shows an EXR picture on a display");
///     arguments.positional("INPUT", input, "an EXR file");
///     arguments.option("--exposure", "EV", exposure, any_value, "factors of two; 0 unless given");
///     if (const auto code = arguments.parse(words)) return *code;
#pragma once

#include "core/plugin/params.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

class Arguments {
public:
    Arguments(const std::string& command, const std::string& summary);
    ~Arguments();
    Arguments(const Arguments&) = delete;
    Arguments& operator=(const Arguments&) = delete;

    /// Words that belong to no option, in the order of declaration. Required unless `optional`.
    void positional(const std::string& name, std::string& value, const std::string& doc,
                    bool optional = false);
    /// Any number of them, none included. The last to be declared.
    void positional(const std::string& name, std::vector<std::string>& values,
                    const std::string& doc);

    /// `names` is "--spp" or "-o,--output"; `placeholder` stands for the value in --help. The value
    /// stays as it is if the option is not given. Only lists may be given more than once.
    void option(const std::string& names, const std::string& placeholder, std::string& value,
                const std::string& doc);
    void option(const std::string& names, const std::string& placeholder,
                std::vector<std::string>& values, const std::string& doc);
    void option(const std::string& names, const std::string& placeholder, double& value,
                Range range, const std::string& doc);
    void option(const std::string& names, const std::string& placeholder,
                std::optional<double>& value, Range range, const std::string& doc);
    void option(const std::string& names, const std::string& placeholder, int& value, Range range,
                const std::string& doc);
    void option(const std::string& names, const std::string& placeholder, std::uint64_t& value,
                Range range, const std::string& doc);
    void option(const std::string& names, const std::string& placeholder,
                std::optional<std::uint64_t>& value, Range range, const std::string& doc);
    /// Numbers between single characters: "1280x720", "0,0,64,64".
    void option(const std::string& names, const std::string& placeholder, std::vector<int>& values,
                char separator, std::size_t count, Range range, const std::string& doc);
    /// "name=value", split at the first equals sign. May be repeated.
    void option(const std::string& names, const std::string& placeholder,
                std::vector<std::pair<std::string, std::string>>& values, const std::string& doc);
    void flag(const std::string& names, bool& value, const std::string& doc);
    /// A paragraph at the end of --help.
    void footer(const std::string& text);

    /// Fills the values. Returns an exit code if there is nothing left to do: help has been
    /// printed, or what is wrong with the arguments.
    std::optional<int> parse(const std::vector<std::string>& words);

private:
    using Take = std::function<void(const std::string& text)>;
    void add(const std::string& names, const std::string& placeholder, const std::string& doc,
             bool repeatable, Take take);
    int usage_error(const std::string& message) const;

    struct State;
    std::unique_ptr<State> state_;
};

/// "lucerna COMMAND WORD…" as a shell would understand it again: for notes of how a file was made.
std::string shell_text(const std::string& command, const std::vector<std::string>& words);

}  // namespace lucerna
