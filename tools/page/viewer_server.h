// `serve` and `view`: a folder over HTTP, with the viewer for its files.
#pragma once

#include "tools/server/file_server.h"

#include <string>

namespace tessera {

// The options of such a server. Without the decoder for browsers (make_server_page()) it serves files alone.
FileServerOptions folder_with_viewer(const std::string& folder);

} // namespace tessera
