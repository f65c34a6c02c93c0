// The HTTP library's server behind a lobby: threads work for requests that are complete only.
#pragma once

#include "format/status.h"
#include "tools/server/connection_lobby.h"

#include <httplib.h>
#include <memory>

namespace tessera {

// Set handlers, bind, then call guard(), then listen_after_bind(). Bodies of requests are not read; the
// connection ends behind the answer to a request that has one. The destructor, after stop(), breaks off what
// is being answered.
class GuardedServer : public httplib::Server {
public:
    GuardedServer();
    ~GuardedServer() override;

    // Allows as many connections as the limits and the system's open files do. Errors: `io`, where threads
    // cannot start.
    Status guard(LobbyLimits limits = {});

private:
    bool process_and_close_socket(socket_t socket) override;
    bool answer(int socket, const std::string& head);

    std::unique_ptr<ConnectionLobby> lobby_; // which its own workers read: never reset
};

} // namespace tessera
