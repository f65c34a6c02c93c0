// The beginning of a Draco stream: what it claims, read before anything is reserved for it.
#pragma once

#include "format/status.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace tessera {

struct DracoHeader {
    std::uint32_t vertices = 0, triangles = 0; // vertices: before seams split them
};

// Errors: invalid_file, also for streams that are no Edgebreaker mesh of version 2.2 without
// metadata, or of more triangles than FORMAT.md allows.
Result<DracoHeader> read_draco_header(std::span<const std::byte> stream);

// Bytes that decoding such a mesh may take, whatever the rest of the stream says: Draco's tables
// of connectivity and attributes, and the mesh itself.
std::uint64_t decoding_bytes(const DracoHeader& header);

} // namespace tessera
