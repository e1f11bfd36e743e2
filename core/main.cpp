// SPDX-License-Identifier: Apache-2.0
/// The program.
#include "core/command_line/program.h"

int main(int argc, char** argv) {
    return lucerna::run_program(std::vector<std::string>(argv + 1, argv + argc));
}
