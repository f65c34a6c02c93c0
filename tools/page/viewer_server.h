// Shared by `serve` and `view`: a folder served over HTTP, with the viewer for its files.
#pragma once

#include "tools/server/file_server.h"

#include <string>

namespace tessera {

// The options of such a server. A build without the decoder for browsers serves the files alone.
FileServerOptions folder_with_viewer(const std::string& folder);

// Waits for Ctrl-C, then ends the process with exit code 0: the server would wait for open
// connections.
[[noreturn]] void serve_until_interrupted();

} // namespace tessera
