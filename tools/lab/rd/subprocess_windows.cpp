#include "tools/lab/rd/subprocess.h"

namespace tessera {

// The rivals are Linux programs.
std::optional<std::string> find_tool(const std::string&) {
    return std::nullopt;
}

Result<ToolRun> run_tool(const std::vector<std::string>& argv, double, const TickFunction&) {
    return Status(ErrorCode::unsupported,
                  argv[0] + ": this build of the tool starts no other programs");
}

Result<ToolRun> run_tool_well(const std::vector<std::string>& argv, double timeout,
                              const TickFunction& tick) {
    return run_tool(argv, timeout, tick);
}

} // namespace tessera
