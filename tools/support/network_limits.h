// How long a command waits for servers: one command, one answer, so these are its process's.
#pragma once

#include <CLI/CLI.hpp>

namespace tessera {

struct NetworkLimits {
    unsigned lowest_rate =
        100; // bytes a second that a transfer must bring; below it for 20 s, it failed
    double total_seconds = 0; // of the command, from its first request on; 0: any
    bool quiet = false;       // no line on the terminal while waiting
};

inline NetworkLimits& network_limits() {
    static NetworkLimits limits;
    return limits;
}

inline void add_network_options(CLI::App& app) {
    NetworkLimits& limits = network_limits();
    app.add_option("--min-rate", limits.lowest_rate,
                   "Bytes a second: a server slower than that for 20 s is asked anew, five times")
        ->check(CLI::Range(1u, 1u << 30))
        ->capture_default_str()
        ->group("Network");
    app.add_option("--max-time", limits.total_seconds,
                   "Seconds that all requests of the command may take together; 0: any")
        ->check(CLI::Range(0.0, 1e9))
        ->capture_default_str()
        ->group("Network");
}

} // namespace tessera
