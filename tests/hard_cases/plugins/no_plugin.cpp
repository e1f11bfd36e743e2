// SPDX-License-Identifier: Apache-2.0
/// A library that is not a plugin.
extern "C" __attribute__((visibility("default"))) int something_else() { return 1; }
