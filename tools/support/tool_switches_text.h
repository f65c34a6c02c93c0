// Switches of coding tools as words: the option --tools.
#pragma once

#include "codec/tile_encoder/tool_switches.h"
#include "format/status.h"

#include <string_view>

namespace tessera {

// "-copies,+rotation"; "none" and "all" stand for every tool. Later words win; the text may be empty.
// Errors: bad_argument, which lists the tools.
Result<ToolSwitches> parse_tool_switches(std::string_view text);

} // namespace tessera
