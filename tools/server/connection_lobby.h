// Connections wait here, without a thread of their own, until a whole request head has come.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tessera {

struct LobbyLimits {
    std::size_t connections = 2000; // waiting at a time
    std::size_t head_bytes = 8192;  // of one request, its blank line included
    // From a head's first byte to its last; and without any byte.
    std::chrono::milliseconds head_time{10000}, idle_time{5000};
    // Who comes when all places are taken gets that of the one who waits longest, if at least so long;
    // else is told to come again.
    std::chrono::milliseconds fair_time{500};
    unsigned workers = 128; // requests answered at a time
};

// Bytes that drip in cost a place, no thread; nothing behind a head is read. All members are thread-safe.
class ConnectionLobby {
public:
    // Answers one request; runs on a worker. `head` ends with its blank line. Returns whether the
    // connection is to be kept. The socket does not block and must not be closed.
    using Answer = std::function<bool(int socket, const std::string& head)>;

    // Throws std::system_error where the system gives neither two threads nor what they wait on.
    ConnectionLobby(const LobbyLimits& limits, Answer answer);
    // Breaks all connections off, those that are being answered too, and waits for the workers.
    ~ConnectionLobby();

    void admit(int socket); // which is the lobby's from now on

    // How long the request that waits longest for a worker does; 0: none waits. Meanwhile slow takers of
    // answers must go.
    std::chrono::duration<double> crowded_for() const;

private:
    using Clock = std::chrono::steady_clock;
    struct Guest {
        int socket = -1;
        std::string bytes;       // that have come
        Clock::time_point since; // the first of them, or the start of waiting for it
    };

    void stop();            // closes all there is
    void seat(Guest guest); // the caller holds the lock
    bool make_room();       // the caller holds the lock
    void watch();
    void receive(int socket);
    void send_away_late();
    void work();
    void leave(Guest guest, const char* words = "") const;

    const LobbyLimits limits_;
    const Answer answer_;
    const int epoll_, wake_;
    mutable std::mutex mutex_; // of what follows
    std::condition_variable ready_;
    std::map<int, Guest> waiting_; // by socket
    std::deque<Guest> heads_;      // complete; `since` then says since when
    std::set<int> answered_;       // sockets
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

} // namespace tessera
