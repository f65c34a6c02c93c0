// What the command line says about an input that may not say it itself.
#pragma once

#include "codec/decoder.h" // DecodeOptions
#include "format/texture.h"

#include <cstdint>
#include <optional>

namespace tessera {

struct TextureHints {
    std::optional<Extent4> size;          // needed by raw files and by foreign EXR mosaics
    std::optional<SampleType> type;       // overrides what the file or its name says
    std::optional<std::uint8_t> channels; // raw files only
    unsigned threads = 0;                 // 0: all cores
    DecodeOptions decode;                 // of a .tess
};

} // namespace tessera
