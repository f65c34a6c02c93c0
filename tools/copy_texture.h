// Texels from a source to a sink, slab by slab in bounded memory.
#pragma once

#include "codec/encoder.h" // ProgressFunction
#include "format/texture.h"

namespace tessera {

// Walks as the sink likes; calls finish(). Errors: those of source and sink.
Status copy_texture(TexelSource& source, TexelSink& sink, unsigned threads,
                    const ProgressFunction& progress, const char* stage);

} // namespace tessera
