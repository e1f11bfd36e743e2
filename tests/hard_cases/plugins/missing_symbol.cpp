// SPDX-License-Identifier: Apache-2.0
/// A library that calls a function that nobody has.
extern "C" int lucerna_function_that_nobody_has();
extern "C" __attribute__((visibility("default"))) int call() {
    return lucerna_function_that_nobody_has();
}
