// SPDX-License-Identifier: Apache-2.0
#include "core/render/interrupt.h"

#include "core/interfaces/command.h"

#include <atomic>
#include <csignal>

#include <unistd.h>

namespace lucerna {

namespace {

std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

struct sigaction previous_int, previous_term;

extern "C" void on_signal(int) {
    if (signalled.exchange(true)) _exit(exit_code::interrupted);
}

}  // namespace

InterruptGuard::InterruptGuard() {
    signalled = false;
    struct sigaction action {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;  // files are being written: their calls are to go on
    sigaction(SIGINT, &action, &previous_int);
    sigaction(SIGTERM, &action, &previous_term);
}

InterruptGuard::~InterruptGuard() {
    sigaction(SIGINT, &previous_int, nullptr);
    sigaction(SIGTERM, &previous_term, nullptr);
}

bool InterruptGuard::interrupted() { return signalled.load(std::memory_order_relaxed); }

void InterruptGuard::interrupt() { signalled = true; }

void ignore_write_signals() {
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace lucerna
