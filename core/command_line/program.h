// SPDX-License-Identifier: Apache-2.0
/// The program as a function: finds the command that is asked for and runs it.
#pragma once

#include <string>
#include <vector>

namespace lucerna {

/// Runs `lucerna ARGUMENT…`: prints what it says, errors too, and returns the exit code.
int run_program(std::vector<std::string> arguments);

}  // namespace lucerna
