// Texels from a source to a sink, slab by slab in bounded memory.
#pragma once

#include "codec/encoder.h" // ProgressFunction
#include "format/texture.h"

namespace tessera {

// Walks as the sink likes; calls finish(). Slabs hold at most `slab_bytes` of texels. Errors: those
// of source and sink; over_budget where the smallest slab is larger.
Status copy_texture(TexelSource& source, TexelSink& sink, unsigned threads,
                    const ProgressFunction& progress, const char* stage,
                    std::uint64_t slab_bytes = 512u << 20);

} // namespace tessera
