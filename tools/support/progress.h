// A progress line on the terminal. There is none in a pipe and with --quiet.
#pragma once

#include "codec/encoder.h" // ProgressFunction

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace tessera {

// Shows how many bytes have arrived from the network, from the second second of waiting on, if no
// Progress object shows a line. Without `bytes`, clears the line. Thread-safe.
void show_waiting(std::optional<std::uint64_t> bytes);

class Progress {
public:
    // The line begins with `title`, usually the verb.
    Progress(std::string title, bool quiet);
    ~Progress(); // clears the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // The callback for the library. Empty if nothing is shown. Valid during the lifetime of this
    // object.
    ProgressFunction function();

private:
    void show(const char* stage, double done, double total);
    std::string title_, stage_;
    bool visible_, drawn_ = false;
    std::chrono::steady_clock::time_point stage_start_, last_;
};

} // namespace tessera
