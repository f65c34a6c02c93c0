// A line on the terminal that says how far long work has come. Silent in a pipe and with --quiet.
#pragma once

#include "codec/encoder.h" // ProgressFunction

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace tessera {

// A line on the terminal of how much has come from a network so far, in the second and later seconds of
// waiting and while no Progress is there; nothing: it is cleared. One caller at a time.
void show_waiting(std::optional<std::uint64_t> bytes);

class Progress {
public:
    // `title`, usually the verb, begins the line.
    Progress(std::string title, bool quiet);
    ~Progress(); // clears the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // For the library; empty when nothing is shown. Valid as long as this object.
    ProgressFunction function();

private:
    void show(const char* stage, double done, double total);
    std::string title_, stage_;
    bool visible_, drawn_ = false;
    std::chrono::steady_clock::time_point stage_start_, last_;
};

} // namespace tessera
