#include "tools/server/connection_lobby.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t head_piece_bytes = 4096;
constexpr int tick_milliseconds = 100; // how late a deadline may be noticed
constexpr std::size_t drained_bytes = 64 << 10;

const char* const too_long_words = "HTTP/1.1 431 Request Header Fields Too Large\r\n"
                                   "Content-Length: 0\r\nConnection: close\r\n\r\n";
const char* const too_slow_words = "HTTP/1.1 408 Request Timeout\r\n"
                                   "Content-Length: 0\r\nConnection: close\r\n\r\n";
const char* const full_words = "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 1\r\n"
                               "Content-Length: 0\r\nConnection: close\r\n\r\n";

// Bytes of the first head in `bytes`, its blank line included; 0 where it is not complete.
std::size_t head_length(const std::string& bytes) {
    const std::size_t end = bytes.find("\r\n\r\n");
    return end == std::string::npos ? 0 : end + 4;
}

} // namespace

ConnectionLobby::ConnectionLobby(const LobbyLimits& limits, Answer answer)
    : limits_(limits), answer_(std::move(answer)), epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    epoll_event event = {};
    event.events = EPOLLIN;
    event.data.fd = wake_;
    try {
        if (epoll_ < 0 || wake_ < 0 || ::epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_, &event) != 0)
            throw std::system_error(errno, std::generic_category());
        threads_.emplace_back([this] { watch(); });
        for (unsigned i = 0; i < limits_.workers; ++i)
            threads_.emplace_back([this] { work(); });
    } catch (const std::system_error&) {
        if (threads_.size() > 1)
            return; // fewer workers serve, too
        stop();
        throw;
    }
}

ConnectionLobby::~ConnectionLobby() {
    stop();
}

void ConnectionLobby::stop() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
        for (const int socket : answered_)
            ::shutdown(socket, SHUT_RDWR);
    }
    const std::uint64_t one = 1;
    (void)!::write(wake_, &one, sizeof one);
    ready_.notify_all();
    for (std::thread& thread : threads_)
        thread.join();
    for (const auto& [socket, guest] : waiting_)
        ::close(socket);
    for (const Guest& guest : heads_)
        ::close(guest.socket);
    ::close(wake_);
    ::close(epoll_);
}

std::chrono::duration<double> ConnectionLobby::crowded_for() const {
    const std::lock_guard lock(mutex_);
    return heads_.empty() ? Clock::duration::zero() : Clock::now() - heads_.front().since;
}

void ConnectionLobby::admit(int socket) {
    ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) | O_NONBLOCK);
    const std::lock_guard lock(mutex_);
    if (waiting_.size() + heads_.size() >= limits_.connections && !make_room())
        return leave({socket, {}, {}}, full_words);
    seat({socket, {}, Clock::now()});
}

// A head that came behind another one is ready at once.
void ConnectionLobby::seat(Guest guest) {
    if (head_length(guest.bytes) > 0) {
        guest.since = Clock::now();
        heads_.push_back(std::move(guest));
        ready_.notify_one();
        return;
    }
    epoll_event event = {};
    event.events = EPOLLIN;
    event.data.fd = guest.socket;
    if (stopping_ || ::epoll_ctl(epoll_, EPOLL_CTL_ADD, guest.socket, &event) != 0)
        return leave(std::move(guest));
    waiting_[guest.socket] = std::move(guest);
}

bool ConnectionLobby::make_room() {
    const auto longest = std::ranges::min_element(
        waiting_, {}, [](const auto& entry) { return entry.second.since; });
    if (longest == waiting_.end() || Clock::now() - longest->second.since < limits_.fair_time)
        return false;
    leave(std::move(longest->second), full_words);
    waiting_.erase(longest);
    return true;
}

// What has come but was not read would make the system withdraw our last words: a little of it is
// thrown away.
void ConnectionLobby::leave(Guest guest, const char* words) const {
    ::send(guest.socket, words, std::strlen(words), MSG_NOSIGNAL | MSG_DONTWAIT);
    ::shutdown(guest.socket, SHUT_WR);
    std::array<char, head_piece_bytes> ignored;
    for (std::size_t drained = 0; drained < drained_bytes;) {
        const ssize_t got = ::recv(guest.socket, ignored.data(), ignored.size(), MSG_DONTWAIT);
        if (got <= 0)
            break;
        drained += static_cast<std::size_t>(got);
    }
    ::close(guest.socket); // which takes it from epoll_, too
}

void ConnectionLobby::watch() {
    std::array<epoll_event, 256> events;
    auto looked = Clock::now();
    for (;;) {
        const int count = ::epoll_wait(epoll_, events.data(), events.size(), tick_milliseconds);
        const std::lock_guard lock(mutex_);
        if (stopping_)
            return;
        for (int i = 0; i < count; ++i)
            receive(events[static_cast<std::size_t>(i)].data.fd);
        if (Clock::now() - looked < std::chrono::milliseconds(tick_milliseconds))
            continue;
        looked = Clock::now();
        send_away_late();
    }
}

void ConnectionLobby::receive(int socket) {
    const auto found = waiting_.find(socket);
    if (found == waiting_.end()) // gone in this round
        return;
    Guest& guest = found->second;
    std::array<char, head_piece_bytes> piece;
    const ssize_t got = ::recv(socket, piece.data(), piece.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EAGAIN || errno == EINTR))
        return;
    if (got > 0 && guest.bytes.empty())
        guest.since = Clock::now();
    guest.bytes.append(piece.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    const std::size_t head = head_length(guest.bytes);
    const bool too_long =
        head > limits_.head_bytes || (head == 0 && guest.bytes.size() >= limits_.head_bytes);
    if (got > 0 && !too_long && head == 0)
        return;
    Guest moved = std::move(guest);
    waiting_.erase(found);
    if (got <= 0 || too_long)
        return leave(std::move(moved), got > 0 ? too_long_words : "");
    ::epoll_ctl(epoll_, EPOLL_CTL_DEL, socket, nullptr);
    seat(std::move(moved));
}

void ConnectionLobby::send_away_late() {
    const auto now = Clock::now();
    for (auto guest = waiting_.begin(); guest != waiting_.end();) {
        const bool begun = !guest->second.bytes.empty();
        if (now - guest->second.since < (begun ? limits_.head_time : limits_.idle_time)) {
            ++guest;
            continue;
        }
        leave(std::move(guest->second), begun ? too_slow_words : "");
        guest = waiting_.erase(guest);
    }
}

void ConnectionLobby::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        ready_.wait(lock, [&] { return stopping_ || !heads_.empty(); });
        if (stopping_)
            return;
        Guest guest = std::move(heads_.front());
        heads_.pop_front();
        answered_.insert(guest.socket);
        lock.unlock();
        const std::size_t length = head_length(guest.bytes);
        bool kept = false;
        try {
            kept = answer_(guest.socket, guest.bytes.substr(0, length));
        } catch (...) { // bad_alloc above all: this connection ends, the others go on
        }
        guest.bytes.erase(0, length);
        guest.since = Clock::now();
        lock.lock();
        answered_.erase(guest.socket);
        if (kept && !stopping_)
            seat(std::move(guest));
        else
            leave(std::move(guest));
    }
}

} // namespace tessera
