// An HTTP server that sends exactly the bytes that a test gives, valid or not.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <functional>
#include <mutex>
#include <netinet/in.h>
#include <optional>
#include <poll.h>
#include <set>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace tessera::test {

// Listens on a free local port, with one thread per connection.
class RawServer {
public:
    // The response to a request: the bytes to send, and whether the connection stays open. The
    // handler gets the request's head and its number, counted from 0. It is called from several
    // threads.
    struct Answer {
        std::string bytes;
        bool keep = true;
        std::size_t pause_at = std::string::npos; // sends no more, stays connected
    };
    using Handler = std::function<Answer(const std::string& head, unsigned number)>;

    explicit RawServer(Handler handler) : handler_(std::move(handler)) {
        listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        sockaddr_in address = {};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
            ::listen(listener_, 64) != 0 ||
            ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
            ADD_FAILURE() << "cannot listen";
        port_ = ntohs(address.sin_port);
        acceptor_ = std::thread([this] { accept_all(); });
    }

    ~RawServer() {
        stopping_ = true;
        ::shutdown(listener_, SHUT_RDWR);
        acceptor_.join();
        for (std::thread& thread : connections_)
            thread.join();
        ::close(listener_);
    }

    std::string url(const std::string& path = "x.tess") const {
        return "http://127.0.0.1:" + std::to_string(port_) + "/" + path;
    }
    unsigned requests() const { return requests_; }
    // The largest number of requests in progress at one time.
    unsigned most_at_once() const { return most_at_once_; }

private:
    void accept_all() {
        while (!stopping_) {
            const int connection = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
            if (connection < 0)
                continue;
            connections_.emplace_back([this, connection] {
                serve(connection);
                ::close(connection);
            });
        }
    }

    // Waits until there are bytes to read, and returns false if the server stops first.
    bool wait(int connection) const {
        while (!stopping_) {
            pollfd descriptor = {connection, POLLIN, 0};
            if (::poll(&descriptor, 1, 20) > 0)
                return true;
        }
        return false;
    }

    void serve(int connection) {
        std::string received;
        for (;;) {
            std::size_t end;
            while ((end = received.find("\r\n\r\n")) == std::string::npos) {
                char buffer[4096];
                if (!wait(connection))
                    return;
                const ssize_t got = ::recv(connection, buffer, sizeof buffer, 0);
                if (got <= 0)
                    return;
                received.append(buffer, static_cast<std::size_t>(got));
            }
            const unsigned now = ++at_once_;
            for (unsigned most = most_at_once_; most < now;)
                if (most_at_once_.compare_exchange_weak(most, now))
                    break;
            const Answer answer = handler_(received.substr(0, end + 2), requests_++);
            received.erase(0, end + 4);
            const bool sent = send_all(connection, answer.bytes.substr(0, answer.pause_at));
            --at_once_;
            if (answer.pause_at != std::string::npos)
                wait(connection); // until the client closes the connection
            if (!sent || !answer.keep || answer.pause_at != std::string::npos)
                return;
        }
    }

    static bool send_all(int connection, const std::string& bytes) {
        for (std::size_t at = 0; at < bytes.size();) {
            const ssize_t sent =
                ::send(connection, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
            if (sent <= 0)
                return false;
            at += static_cast<std::size_t>(sent);
        }
        return true;
    }

    Handler handler_;
    int listener_ = -1;
    int port_ = 0;
    std::atomic<bool> stopping_{false};
    std::atomic<unsigned> requests_{0}, at_once_{0}, most_at_once_{0};
    std::thread acceptor_;
    std::vector<std::thread> connections_; // only acceptor_ uses them until it ends
};

// The value of a field in a request's head, or "" if it is absent.
inline std::string field_of(const std::string& head, const std::string& name) {
    const std::size_t at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos)
        return "";
    const std::size_t begin = at + name.size() + 4;
    return head.substr(begin, head.find("\r\n", begin) - begin);
}

// The byte range that a request asks for, first and last byte. Empty if it has no single range.
inline std::optional<std::pair<std::uint64_t, std::uint64_t>> range_of(const std::string& head) {
    unsigned long long first = 0, last = 0;
    if (std::sscanf(field_of(head, "Range").c_str(), "bytes=%llu-%llu", &first, &last) != 2)
        return std::nullopt;
    return std::pair<std::uint64_t, std::uint64_t>{first, last};
}

// The parts of a correct response to a range request, which tests can then falsify.
struct PartAnswer {
    std::string status = "206 Partial Content";
    std::uint64_t first = 0, last = 0, total = 0;
    std::string etag = "\"v1\"", body;
    std::vector<std::string> more; // header fields
    std::optional<std::uint64_t> content_length;

    PartAnswer(const std::string& head, const std::string& file) : total(file.size()) {
        const auto range = range_of(head);
        if (!range || range->first >= file.size()) {
            ADD_FAILURE() << "no good range in\n" << head;
            return;
        }
        first = range->first;
        last = std::min<std::uint64_t>(range->second, file.size() - 1);
        body = file.substr(first, last - first + 1);
    }
    std::string text() const {
        std::string all =
            "HTTP/1.1 " + status + "\r\nContent-Range: bytes " + std::to_string(first) + "-" +
            std::to_string(last) + "/" + std::to_string(total) +
            "\r\nContent-Length: " + std::to_string(content_length.value_or(body.size())) + "\r\n";
        if (!etag.empty())
            all += "ETag: " + etag + "\r\n";
        for (const std::string& field : more)
            all += field + "\r\n";
        return all + "\r\n" + body;
    }
};

} // namespace tessera::test
