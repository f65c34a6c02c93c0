// Other programs, run without a shell: their arguments are a list, their words are kept for
// messages, they end when their time is up or we are interrupted.
#pragma once

#include "format/status.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

struct ToolRun {
    int exit_code = 0;
    double seconds = 0; // by the clock on the wall
    std::string said;   // standard output and error; the last part of it, if it is much
};

// Called about every tenth of a second while a tool runs.
using TickFunction = std::function<void()>;

// The path of the program `name`, from PATH.
std::optional<std::string> find_tool(const std::string& name);

// Runs argv[0], a path or a name on PATH, and waits. Nothing is on its standard input. Thread-safe.
// Errors: io, where it cannot be started; runtime, where it was killed by a signal, took longer
// than `timeout` seconds (it and its children are killed) or we are interrupted.
Result<ToolRun> run_tool(const std::vector<std::string>& argv, double timeout,
                         const TickFunction& tick = {});

// The same, where any exit code but 0 is an error too: runtime, with the last words of the tool.
Result<ToolRun> run_tool_well(const std::vector<std::string>& argv, double timeout,
                              const TickFunction& tick = {});

} // namespace tessera
