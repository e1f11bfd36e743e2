// SPDX-License-Identifier: Apache-2.0
/// A TCP connection to a viewer that may be absent, slow, or go away.
#pragma once

#include "core/base/error.h"
#include "plugins/previews/place.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

namespace lucerna {

class TcpSender {
public:
    using Clock = std::chrono::steady_clock;

    TcpSender() = default;
    ~TcpSender() { disconnect(); }
    TcpSender(const TcpSender&) = delete;
    TcpSender& operator=(const TcpSender&) = delete;

    /// Looks the host up. Throws Error if nobody knows it.
    void find(const Place& place);
    /// Any thread may ask.
    bool connected() const { return connected_; }
    /// Throws Error with the reason if there is no connection after `patience`.
    void connect(Clock::duration patience);
    /// Throws Error, without a connection left, if the other side is gone, or takes nothing for as
    /// long as `patience`.
    void send(std::string_view bytes, Clock::duration patience);
    void disconnect() {
        connected_ = false;
        if (socket_ >= 0) close(std::exchange(socket_, -1));
    }
    /// From now on nothing waits. Any thread may call it.
    void cancel() { cancelled_ = true; }

private:
    /// Waits until the socket can be written to; false if it cannot for so long.
    bool wait(Clock::duration patience) const;

    struct Free {
        void operator()(addrinfo* list) const { freeaddrinfo(list); }
    };
    std::unique_ptr<addrinfo, Free> addresses_;
    int socket_ = -1;
    std::atomic<bool> connected_{false}, cancelled_{false};
};

inline void TcpSender::find(const Place& place) {
    addrinfo hints{}, *found = nullptr;
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    const std::string port = std::to_string(place.port);
    const int problem = getaddrinfo(place.host.c_str(), port.c_str(), &hints, &found);
    if (problem != 0) {
        throw Error(fmt::format("the host {} cannot be found: {}", quote(place.host),
                                gai_strerror(problem)));
    }
    addresses_.reset(found);
}

inline void TcpSender::connect(Clock::duration patience) {
    int reason = 0;
    for (const addrinfo* a = addresses_.get(); a; a = a->ai_next) {
        disconnect();
        const int type = a->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC;
        socket_ = socket(a->ai_family, type, a->ai_protocol);
        if (socket_ < 0) throw Error(std::strerror(errno));
        reason = ::connect(socket_, a->ai_addr, a->ai_addrlen) == 0 ? 0 : errno;
        if (reason == EINPROGRESS && !wait(patience)) reason = ETIMEDOUT;
        if (reason == EINPROGRESS) {
            socklen_t size = sizeof reason;
            getsockopt(socket_, SOL_SOCKET, SO_ERROR, &reason, &size);
        }
        if (reason == 0) {
            connected_ = true;
            return;
        }
    }
    disconnect();
    throw Error(std::strerror(reason));
}

inline void TcpSender::send(std::string_view bytes, Clock::duration patience) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            if (wait(patience)) continue;
            disconnect();
            throw Error("it takes no data");
        } else if (errno != EINTR) {
            const int reason = errno;
            disconnect();
            throw Error(std::strerror(reason));
        }
    }
}

inline bool TcpSender::wait(Clock::duration patience) const {
    constexpr int slice = 50;  // [ms]
    const Clock::time_point end = Clock::now() + patience;
    while (!cancelled_ && Clock::now() < end) {
        pollfd state = {.fd = socket_, .events = POLLOUT, .revents = 0};
        if (poll(&state, 1, slice) > 0) return true;
    }
    return false;
}

}  // namespace lucerna
