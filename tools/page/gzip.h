// Bytes as a browser's DecompressionStream unpacks them.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tessera {

// As small as zlib makes it, with no time of day: the same bytes every time. Errors: runtime (out of memory).
Result<std::vector<std::byte>> gzip(std::span<const std::byte> bytes);

std::string base64(std::span<const std::byte> bytes);

} // namespace tessera
