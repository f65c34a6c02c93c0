// The tool: its verbs, and the one that was called.
#pragma once

namespace tessera {

// Of main(). Says what went wrong on standard error; returns the exit code.
int run_tool(int argc, char** argv);

} // namespace tessera
