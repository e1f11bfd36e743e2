// SPDX-License-Identifier: Apache-2.0
/// Stopping a render politely: signals.
#pragma once

namespace lucerna {

/// While it lives, SIGINT and SIGTERM only set a flag; a second one ends the process at once. Only
/// one may live at a time.
class InterruptGuard {
public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    /// A signal has arrived. Cheap; any thread may ask.
    static bool interrupted();
    /// What a first signal does, and no more if it comes again. Any thread may call it.
    static void interrupt();
};

/// Lets writing to a full disk or a closed pipe fail with an error message instead of killing the
/// process (SIGXFSZ, SIGPIPE).
void ignore_write_signals();

}  // namespace lucerna
