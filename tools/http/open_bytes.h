// Opens a file by its name: a path, "-" for standard input, or a URL.
#pragma once

#include "format/byte_source.h"
#include "tools/http/glb_payload.h"
#include "tools/support/traffic.h"
#include "tools/support/url.h"

#include <memory>
#include <string>

namespace tessera {

// Opens a path (open_file()), "-" (open_standard_input()) or an http:// or https:// URL
// (HttpSource). Of a .glb it opens the .tess file inside (unpack_glb()), which the name may choose
// (split_glb_name()). Errors: theirs; bad_argument (another scheme); unsupported (a URL in a build
// without TESSERA_HTTP).
Result<std::unique_ptr<ByteSource>> open_bytes(const std::string& name);

// How many names open_bytes() has for what is in the file: the number of Tessera textures of a .glb,
// if the name ends so and chooses none; else 1. Errors: those of open_bytes().
Result<std::size_t> texture_count(const std::string& name);

// The requests and bytes so far if `source` is a URL, else nothing. Thread-safe.
std::optional<Traffic> network_traffic(const ByteSource& source);

// ", 3 requests, 65.5 kB received" if `source` is a URL, else "".
std::string transfer_text(const ByteSource& source);

} // namespace tessera
