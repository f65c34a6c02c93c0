// The path of the tool that the tests of the command line run.
#pragma once

#include <cstdlib>
#include <string>

namespace tessera::test {

// The tool of this build. The environment variable TESSERA_TOOL names another, such as a script that
// runs tessera.exe under wine.
inline std::string tool_under_test() {
    const char* const other = std::getenv("TESSERA_TOOL");
    return other != nullptr ? other : TESSERA_TOOL;
}

} // namespace tessera::test
