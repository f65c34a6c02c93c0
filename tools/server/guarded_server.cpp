#include "tools/server/guarded_server.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <linux/sockios.h>
#include <netdb.h>
#include <poll.h>
#include <string_view>
#include <strings.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <system_error>

namespace tessera {
namespace {

constexpr int backlog = 1024;         // connections that wait to be accepted
constexpr rlim_t files_besides = 300; // of the workers' and the process
constexpr int poll_milliseconds = 100;
// Who takes an answer must take it at this rate, all the time: what was taken before counts for nothing. It is
// looked at after so many seconds of waiting, sooner when others wait, too. While these wait, the rate that is
// asked for doubles every half a second, 8 times at most: those who hold a worker longest for the least go first.
constexpr double slowest_bytes_a_second = 4096;
constexpr double usual_look_seconds = 10, crowded_look_seconds = 0.5;
constexpr double most_doublings = 8;
constexpr int keep_alive_seconds = 5; // as the lobby's idle_time

// Each accepted connection goes to the lobby on the thread that accepts.
class NoQueue : public httplib::TaskQueue {
public:
    void enqueue(std::function<void()> task) override { task(); }
    void shutdown() override {}
};

void describe_address(const sockaddr_storage& address, socklen_t length, std::string& ip,
                      int& port) {
    char host[NI_MAXHOST] = "", service[NI_MAXSERV] = "";
    if (::getnameinfo(reinterpret_cast<const sockaddr*>(&address), length, host, sizeof host,
                      service, sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
        return;
    ip = host;
    port = std::atoi(service);
}

// Reads what has come, a head, and nothing else; writes at the peer's pace, if that is one.
class HeadStream : public httplib::Stream {
public:
    HeadStream(int socket, std::string_view head, const ConnectionLobby& lobby)
        : socket_(socket), head_(head), lobby_(lobby) {}

    bool is_readable() const override { return !head_.empty(); }
    bool is_writable() const override { return wait(); }
    ssize_t read(char* out, size_t size) override {
        const std::size_t count = std::min(size, head_.size());
        std::memcpy(out, head_.data(), count);
        head_.remove_prefix(count);
        return static_cast<ssize_t>(count);
    }
    ssize_t write(const char* bytes, size_t size) override {
        // All of it: not every caller goes on with what is left.
        for (std::size_t done = 0; done < size;) {
            const ssize_t sent =
                ::send(socket_, bytes + done, size - done, MSG_NOSIGNAL | MSG_DONTWAIT);
            if (sent < 0 && (errno == EAGAIN ? !wait() : errno != EINTR))
                return -1;
            done += static_cast<std::size_t>(std::max<ssize_t>(sent, 0));
            sent_ += std::max<ssize_t>(sent, 0);
        }
        return static_cast<ssize_t>(size);
    }
    void get_remote_ip_and_port(std::string& ip, int& port) const override {
        sockaddr_storage address = {};
        socklen_t length = sizeof address;
        if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
            describe_address(address, length, ip, port);
    }
    void get_local_ip_and_port(std::string& ip, int& port) const override {
        sockaddr_storage address = {};
        socklen_t length = sizeof address;
        if (::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
            describe_address(address, length, ip, port);
    }
    socket_t socket() const override { return socket_; }

private:
    bool wait() const {
        pollfd wanted{socket_, POLLOUT, 0};
        while (::poll(&wanted, 1, poll_milliseconds) == 0) {
            waited_ += poll_milliseconds / 1000.0;
            if (!is_taking())
                return false;
        }
        return (wanted.revents & (POLLERR | POLLHUP)) == 0;
    }

    // What lies in the system's own buffer, which may be megabytes, is not the peer's yet.
    ssize_t taken() const {
        int queued = 0; // also of answers before this one
        ::ioctl(socket_, SIOCOUTQ, &queued);
        return sent_ - queued;
    }

    // Whether enough was taken since the last look.
    bool is_taking() const {
        const double crowded = lobby_.crowded_for().count();
        if (waited_ < (crowded > 0 ? crowded_look_seconds : usual_look_seconds))
            return true;
        const double rate =
            slowest_bytes_a_second *
            std::exp2(std::min(std::floor(crowded / crowded_look_seconds), most_doublings));
        const ssize_t now = taken();
        const bool is_enough = static_cast<double>(now - taken_) >= rate * waited_;
        waited_ = 0;
        taken_ = now;
        return is_enough;
    }

    const int socket_;
    std::string_view head_;
    const ConnectionLobby& lobby_;
    ssize_t sent_ = 0;                // to the system
    mutable double waited_ = 0;       // seconds for the peer, since it was looked at
    mutable ssize_t taken_ = taken(); // until then
};

// Whether a line of the head is the field `name`.
bool has_field(std::string_view head, std::string_view name) {
    for (std::size_t at = head.find('\n'); at != head.npos; at = head.find('\n', at + 1)) {
        const std::string_view line = head.substr(at + 1);
        if (line.size() > name.size() && line[name.size()] == ':' &&
            ::strncasecmp(line.data(), name.data(), name.size()) == 0)
            return true;
    }
    return false;
}

// The most open files that this process may have, raised as far as it may.
rlim_t allow_open_files() {
    rlimit limit = {};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0)
        return 1024;
    limit.rlim_cur = std::max<rlim_t>(limit.rlim_cur, std::min<rlim_t>(limit.rlim_max, 8192));
    ::setrlimit(RLIMIT_NOFILE, &limit);
    ::getrlimit(RLIMIT_NOFILE, &limit);
    return limit.rlim_cur;
}

} // namespace

GuardedServer::GuardedServer() {
    new_task_queue = [] { return new NoQueue; };
    set_keep_alive_timeout(keep_alive_seconds);
}

GuardedServer::~GuardedServer() = default;

Status GuardedServer::guard(LobbyLimits limits) {
    const rlim_t files = allow_open_files();
    limits.connections = std::min<std::size_t>(
        limits.connections, files > 2 * files_besides ? files - files_besides : files / 2);
    try {
        lobby_ = std::make_unique<ConnectionLobby>(
            limits, [this](int socket, const std::string& head) { return answer(socket, head); });
    } catch (const std::system_error& error) {
        return {ErrorCode::io, std::string("the server cannot start: ") + error.what()};
    }
    ::listen(svr_sock_, backlog); // the library's own is 5
    return {};
}

bool GuardedServer::process_and_close_socket(socket_t socket) {
    lobby_->admit(socket);
    return true;
}

bool GuardedServer::answer(int socket, const std::string& head) {
    HeadStream stream(socket, head, *lobby_);
    const bool has_body = has_field(head, "Content-Length") || has_field(head, "Transfer-Encoding");
    bool closed = false;
    return process_request(stream, has_body, closed, {}) && !closed && !has_body;
}

} // namespace tessera
