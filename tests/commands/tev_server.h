// SPDX-License-Identifier: Apache-2.0
/// What tev does with the packets of its protocol, in as far as pictures are concerned.
#pragma once

#include "core/image/image.h"

#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace lucerna {

/// A socket that listens on a port of this machine. [0: any]
inline int listening_socket(int& port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (bind(socket, generic, size) != 0 || listen(socket, 8) != 0) {
        throw std::runtime_error(std::strerror(errno));
    }
    getsockname(socket, generic, &size);
    port = ntohs(address.sin_port);
    return socket;
}

/// The fields of a packet, after its length.
class PacketReader {
public:
    explicit PacketReader(std::string_view bytes) : bytes_(bytes) {}

    template <typename T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string text() {
        const std::string result(bytes_.substr(0, bytes_.find('\0')));
        take(result.size() + 1);
        return result;
    }
    std::size_t left() const { return bytes_.size(); }

private:
    std::string_view take(std::size_t count) {
        if (count > bytes_.size()) throw std::runtime_error("a packet that is too short");
        const std::string_view result = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return result;
    }
    std::string_view bytes_;
};

class TevServer {
public:
    enum class Manner {
        reads,
        never_reads,       ///< and keeps the connection
        closes_each_time,  ///< the connection, after the first bytes
    };

    explicit TevServer(Manner manner = Manner::reads, int port = 0)
        : manner_(manner), port_(port), socket_(listening_socket(port_)), thread_([this] {
              while (!stop_) serve();
          }) {}
    ~TevServer() { stop(); }
    TevServer(const TevServer&) = delete;
    TevServer& operator=(const TevServer&) = delete;

    int port() const { return port_; }
    std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
    /// Reads what has been sent and ends.
    void stop() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        if (socket_ >= 0) close(socket_);
        socket_ = -1;
    }
    /// All that follows: after stop().
    const std::map<std::string, Image>& images() const { return images_; }
    /// Names of the images in the order in which they were created.
    const std::vector<std::string>& created() const { return created_; }
    int connections() const { return connections_; }
    int updates() const { return updates_; }

private:
    static bool readable(int socket) {
        pollfd state = {.fd = socket, .events = POLLIN, .revents = 0};
        return poll(&state, 1, 20) > 0;
    }
    void serve() {
        if (!readable(socket_)) return;
        const int connection = accept(socket_, nullptr, nullptr);
        ++connections_;
        while (manner_ == Manner::never_reads && !stop_) usleep(1000);
        std::string bytes(1 << 16, '\0'), unread;
        while (manner_ != Manner::never_reads) {
            if (!readable(connection)) {
                if (stop_) break;
                continue;
            }
            const ssize_t count = recv(connection, bytes.data(), bytes.size(), 0);
            if (count <= 0 || manner_ == Manner::closes_each_time) break;
            unread.append(bytes, 0, static_cast<std::size_t>(count));
            read_packets(unread);
        }
        close(connection);
    }
    void read_packets(std::string& unread) {
        std::uint32_t size = 0;
        while (unread.size() >= sizeof size) {
            std::memcpy(&size, unread.data(), sizeof size);
            if (unread.size() < size) return;
            PacketReader packet(std::string_view(unread).substr(sizeof size, size - sizeof size));
            try {
                read_packet(packet);
            } catch (const std::exception& e) {
                ADD_FAILURE() << e.what();
            }
            unread.erase(0, size);
        }
    }
    void read_packet(PacketReader& packet) {
        const int type = packet.number<std::int8_t>();
        if (type == 4) {
            create(packet);
        } else if (type == 6) {
            update(packet);
        } else if (type == 2) {
            EXPECT_EQ(images_.erase(packet.text()), 1u);
        } else {
            ADD_FAILURE() << "packet of type " << type;
        }
        EXPECT_EQ(packet.left(), 0u);
    }
    void create(PacketReader& packet) {
        packet.number<std::int8_t>();
        const std::string name = packet.text();
        const int width = packet.number<std::int32_t>(), height = packet.number<std::int32_t>();
        std::vector<std::string> channels(static_cast<std::size_t>(packet.number<std::int32_t>()));
        for (std::string& channel : channels) channel = packet.text();
        images_[name] = Image(width, height, channels);
        created_.push_back(name);
    }
    void update(PacketReader& packet) {
        packet.number<std::int8_t>();
        Image& image = images_.at(packet.text());
        std::vector<std::size_t> channels(static_cast<std::size_t>(packet.number<std::int32_t>()));
        for (std::size_t& channel : channels) channel = image.channel(packet.text()).value();
        const int x = packet.number<std::int32_t>(), y = packet.number<std::int32_t>();
        const int width = packet.number<std::int32_t>(), height = packet.number<std::int32_t>();
        std::vector<std::int64_t> offsets, strides;
        for (std::size_t c = 0; c < channels.size(); ++c) {
            offsets.push_back(packet.number<std::int64_t>());
        }
        for (std::size_t c = 0; c < channels.size(); ++c) {
            strides.push_back(packet.number<std::int64_t>());
        }
        std::vector<float> values;
        while (packet.left() > 0) values.push_back(packet.number<float>());
        for (int i = 0; i < width * height; ++i) {
            float* const pixel = image.at(x + i % width, y + i / width);
            for (std::size_t c = 0; c < channels.size(); ++c) {
                const std::int64_t at = offsets[c] + i * strides[c];
                pixel[channels[c]] = values.at(static_cast<std::size_t>(at));
            }
        }
        ++updates_;
    }

    Manner manner_;
    int port_, socket_;
    std::atomic<bool> stop_{false};
    std::map<std::string, Image> images_;
    std::vector<std::string> created_;
    std::atomic<int> connections_{0}, updates_{0};
    std::thread thread_;
};

}  // namespace lucerna
