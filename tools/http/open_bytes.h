// A .tess file by name: a path, "-" for standard input, or the URL of one on a web server.
#pragma once

#include "format/byte_source.h"
#include "tools/support/traffic.h"
#include "tools/support/url.h"

#include <memory>
#include <string>

namespace tessera {

// Opens a path (open_file()), "-" (open_standard_input()) or an http:// or https:// URL (HttpSource). Errors: those of the two;
// bad_argument (another scheme); unsupported (a URL, and TESSERA_HTTP is off in this build).
Result<std::unique_ptr<ByteSource>> open_bytes(const std::string& name);

// What has come from a source over a network so far; nothing for other sources. Thread-safe.
std::optional<Traffic> network_traffic(const ByteSource& source);

// ", 3 requests, 65.5 kB received" after a source that came over a network, else "".
std::string transfer_text(const ByteSource& source);

} // namespace tessera
