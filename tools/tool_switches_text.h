// Switches of coding tools as words: the option --tools.
#pragma once

#include <string>

namespace tessera {

std::string tool_switches_help();

} // namespace tessera
