// A program that runs verbs of the tool.
#pragma once

#include "tools/verbs/command.h"

#include <functional>
#include <span>

namespace tessera {

// run_tool(), in a process that signals end and exceptions do not.
int run_program(int argc, char** argv, std::span<const Verb> verbs,
                const std::function<int()>& who_knows_more = {});

} // namespace tessera
