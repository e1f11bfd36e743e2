// SPDX-License-Identifier: Apache-2.0
/// Error numbers of the system, in as far as files are concerned.
#pragma once

namespace lucerna {

/// Whether the same may succeed later, or on another machine: a full disk, a network file system
/// that has failed. `error` is a value of errno.
bool may_pass(int error);

}  // namespace lucerna
