// How long a command waits for servers. A process runs one command, so the limits are global.
#pragma once

#include "tools/support/option_checks.h"

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
    OptionGroup group(app, "Network");
    group.option("--min-rate", "N", network_limits().lowest_rate,
                 "Bytes a second; slower servers are retried after 20 s. Default: 100",
                 CLI::Range(1u, 1u << 30));
    group.option("--max-time", "SECONDS", network_limits().total_seconds,
                 "Limit for the requests of the command together. Default: none",
                 CLI::Range(0.0, 1e9));
}

} // namespace tessera
