#include "tools/tool_switches_text.h"

#include "codec/encoder.h"

namespace tessera {

std::string tool_switches_help() {
    return "Coding tools to switch off (-) or on (+) on top of the effort, with commas: "
           "--tools=-copies,+grids; none and all stand for every tool.\n" +
           coding_tools_help();
}

} // namespace tessera
