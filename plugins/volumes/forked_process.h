// SPDX-License-Identifier: Apache-2.0
/// A function that runs in a process of its own, so that its crash is not the program's.
///
/// The process is a copy of this one (fork) with a single thread. It must not wait for what other
/// threads did here: memory is safe, since the C library holds its locks while it forks, but TBB is
/// not. It ends without destructors.
#pragma once

#include "core/base/error.h"

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <span>

namespace lucerna {

class ForkedProcess {
public:
    /// Where the process writes to what this one reads.
    class Output {
    public:
        explicit Output(int descriptor) : descriptor_(descriptor) {}
        /// Ends the process if nobody reads any more.
        void write(std::span<const std::uint8_t> bytes) const;

    private:
        int descriptor_;
    };

    /// Starts `task`, whose exceptions end the process. Throws Error if it cannot be started.
    explicit ForkedProcess(const std::function<void(const Output&)>& task);
    /// Ends the process if it still runs.
    ~ForkedProcess();
    ForkedProcess(const ForkedProcess&) = delete;
    ForkedProcess& operator=(const ForkedProcess&) = delete;

    /// Fills `bytes` with what the process writes next; false if it ends before.
    bool read(std::span<std::uint8_t> bytes);
    /// Whether the process was ended by SIGKILL, as the system does when memory runs out. Waits for
    /// its end.
    bool killed();

private:
    pid_t process_ = -1;  ///< -1 when it has been waited for
    int input_ = -1;
    int status_ = 0;
    void wait();
};

}  // namespace lucerna
