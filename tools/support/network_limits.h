// How long a command waits for servers. A process runs one command, so the limits are global.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera {

struct NetworkLimits {
    unsigned lowest_rate = 100; // bytes a second; a transfer that is slower for 20 s has failed
    double total_seconds = 0;   // from the first request of the command; 0: no limit
    bool quiet = false;         // print no line on the terminal while waiting
};

inline NetworkLimits& network_limits() {
    static NetworkLimits limits;
    return limits;
}

inline void add_network_options(CLI::App& app) {
    NetworkLimits& limits = network_limits();
    app.add_option("--min-rate", limits.lowest_rate,
                   "Bytes a second; if a server is slower for 20 s, the request is repeated, up to "
                   "four times. Default: 100")
        ->check(CLI::Range(1u, 1u << 30))
        ->option_text("N")
        ->group("Network");
    app.add_option("--max-time", limits.total_seconds,
                   "Seconds that the requests of the command may take together. Default: no limit")
        ->check(CLI::Range(0.0, 1e9))
        ->option_text("SECONDS")
        ->group("Network");
}

} // namespace tessera
