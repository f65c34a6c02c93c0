// Runs other programs without a shell. Arguments are a list, output is captured for messages, and
// a program is killed when its time is up or the user interrupts.
#pragma once

#include "format/status.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct ToolRun {
    int exit_code = 0;
    double seconds = 0; // wall clock
    std::string said;   // standard output and error; only the end if it is long
};

// Called about ten times per second while a tool runs.
using TickFunction = std::function<void()>;

// Searches PATH for the program `name` and returns its path.
std::optional<std::string> find_tool(const std::string& name);

// Runs argv[0], a path or a name on PATH, and waits for it. Its standard input is empty.
// Thread-safe. Errors: io, if it cannot be started; runtime, if a signal ended it, if it took
// longer than `timeout` seconds (it is killed with its children) or if the user interrupts.
Result<ToolRun> run_tool(const std::vector<std::string>& argv, double timeout,
                         const TickFunction& tick = {});

// Like run_tool(), but a non-zero exit code is an error too: runtime, with the last line that the
// tool printed.
Result<ToolRun> run_tool_well(const std::vector<std::string>& argv, double timeout,
                              const TickFunction& tick = {});

} // namespace tessera
