// SPDX-License-Identifier: Apache-2.0
/// Failures that may pass, told to whoever started the program: what schedulers run commands with
/// `exit_code::try_again` again for.
#pragma once

#include "core/base/error.h"
#include "core/base/system_error.h"
#include "core/interfaces/command.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

namespace lucerna {

/// The exit code of `action`; if a file cannot be read or written now but may be later, prints
/// which and returns `exit_code::try_again`.
template <typename Action>
int or_try_again(const Action& action) {
    try {
        return action();
    } catch (const TransientFileError& e) {
        fmt::print(stderr, "{}\n", e.what());
    } catch (const std::filesystem::filesystem_error& e) {
        if (!may_pass(e.code().value())) throw;
        fmt::print(stderr, "{}: looking at it failed: {}; try again\n", e.path1().string(),
                   e.code().message());
    }
    return exit_code::try_again;
}

}  // namespace lucerna
