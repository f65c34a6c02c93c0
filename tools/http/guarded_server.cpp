#include "tools/http/guarded_server.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <netdb.h>
#include <poll.h>
#include <string_view>
#include <strings.h>
#include <sys/resource.h>
#include <sys/socket.h>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int backlog = 1024;         // connections that wait to be accepted
constexpr rlim_t files_besides = 300; // of the workers' and the process
constexpr int poll_milliseconds = 100;
// Who takes an answer must take it at this rate, but for a grace, which is short when others wait.
constexpr double slowest_bytes_a_second = 4096;
constexpr double grace_seconds = 10, crowded_grace_seconds = 0.5;
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
            const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
            const double grace = lobby_.is_crowded() ? crowded_grace_seconds : grace_seconds;
            if (seconds > grace + static_cast<double>(sent_) / slowest_bytes_a_second)
                return false;
        }
        return (wanted.revents & (POLLERR | POLLHUP)) == 0;
    }

    const int socket_;
    std::string_view head_;
    const ConnectionLobby& lobby_;
    const Clock::time_point start_ = Clock::now();
    ssize_t sent_ = 0;
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

void GuardedServer::guard(LobbyLimits limits) {
    const rlim_t files = allow_open_files();
    limits.connections = std::min<std::size_t>(
        limits.connections, files > 2 * files_besides ? files - files_besides : files / 2);
    lobby_ = std::make_unique<ConnectionLobby>(
        limits, [this](int socket, const std::string& head) { return answer(socket, head); });
    ::listen(svr_sock_, backlog); // the library's own is 5
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
