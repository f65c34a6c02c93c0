// The command line of `tessera`.
#pragma once

namespace tessera {

// Runs the verb that the command line names. Prints errors to standard error. Returns the exit code.
int run_tool(int argc, char** argv);

} // namespace tessera
