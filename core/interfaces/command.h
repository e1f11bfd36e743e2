// SPDX-License-Identifier: Apache-2.0
/// One verb of the command line: `lucerna render …` is plugins/commands/render.cpp.
#pragma once

#include "core/plugin/plugin.h"

#include <string>
#include <vector>

namespace lucerna {

/// What a command returns to the shell.
namespace exit_code {
inline constexpr int success = 0;
inline constexpr int failure = 1;        ///< rendering failed
inline constexpr int usage = 2;          ///< wrong arguments
inline constexpr int scene = 3;          ///< the scene or the colour configuration is wrong
inline constexpr int plugin = 4;         ///< a plugin library cannot be loaded
inline constexpr int file = 5;           ///< a file cannot be read or written
inline constexpr int comparison = 6;     ///< images differ by more than was allowed
inline constexpr int try_again = 75;     ///< a file cannot be read or written, but may be later
inline constexpr int interrupted = 130;  ///< stopped by SIGINT or SIGTERM, image written
}  // namespace exit_code

class Command : public Object {
public:
    static constexpr const char* kind = "command";
    ~Command() override;

    /// Runs with the arguments after the verb and returns the exit code. Throws Error.
    virtual int run(const std::vector<std::string>& arguments) const = 0;
};

}  // namespace lucerna
