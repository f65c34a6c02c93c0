// The tool: its verbs, and the one that was called.
#pragma once

#include "tools/verbs/command.h"

#include <functional>
#include <span>

namespace tessera {

// `help` and `version` are among any verbs. Says what went wrong on standard error; returns the exit code.
// `who_knows_more`: what is no correct use of these verbs is left to it, before anything was read or written.
int run_tool(int argc, char** argv, std::span<const Verb> verbs,
             const std::function<int()>& who_knows_more = {});

} // namespace tessera
