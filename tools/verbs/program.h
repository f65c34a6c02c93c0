// What main() of both programs is: `tessera`, and `tessera-full` for what that hands over.
#pragma once

#include "tools/verbs/command.h"

#include <functional>
#include <span>

namespace tessera {

// run_tool(), in a process that signals end and exceptions do not.
int run_program(int argc, char** argv, std::span<const Verb> verbs,
                const std::function<int()>& who_knows_more = {});

// Goes on as `tessera-full` with the same arguments: the program beside this one, or where both are installed.
// Returns only where neither can be started: it has said why, and this is the exit code.
int become_full_program(char** argv);

} // namespace tessera
