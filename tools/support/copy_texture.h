// Copies texels from a source to a sink, slab by slab in bounded memory.
#pragma once

#include "codec/encoder.h" // ProgressFunction
#include "format/texture.h"

namespace tessera {

// Copies in the order that the sink prefers, then calls finish(). Slabs hold at most `slab_bytes`
// of texels. Errors: those of source and sink; over_budget if the smallest slab is larger.
Status copy_texture(TexelSource& source, TexelSink& sink, unsigned threads,
                    const ProgressFunction& progress, const char* stage,
                    std::uint64_t slab_bytes = 512u << 20);

} // namespace tessera
