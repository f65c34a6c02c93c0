// What Assimp takes a PLY's word for: that its header ends, how many elements there are and how long lists are.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <span>

namespace tessera::corpus {

// Walks the file once. Errors: invalid_file, with the line or element, for a header that is none, for text that
// is not one element a line, and for more elements or longer lists than the file has bytes for.
Status check_ply(std::span<const std::byte> file);

} // namespace tessera::corpus
