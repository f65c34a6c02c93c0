// gzip and base64, for bytes inside a page.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// A gzip stream at zlib's best compression, without a time stamp, so that equal bytes give equal
// streams. Errors: runtime (out of memory).
Result<std::vector<std::byte>> gzip(std::span<const std::byte> bytes);

std::string base64(std::span<const std::byte> bytes);

} // namespace tessera
