// What the command line says about an input that may not say it itself.
#pragma once

#include "codec/decoder.h" // DecodeOptions
#include "format/texture.h"
#include "tools/support/view_order.h"

#include <cstdint>
#include <optional>
#include <string>

namespace tessera {

// How pictures of views lie and are named, where they do not say it themselves.
struct ViewHints {
    std::string pattern;            // of names, see view_pattern.h; empty: recognised
    std::optional<ViewGrid> grid;   // of the cameras
    std::optional<ViewGrid> quilt;  // views in columns x rows of one picture
    std::optional<ViewGrid> mosaic; // angular images of s x t pixels, side by side in one picture
    std::optional<ViewOrder> order; // of the views of a folder or a quilt
};

struct TextureHints {
    std::optional<Extent4> size;          // needed by raw files and by foreign EXR mosaics
    std::optional<SampleType> type;       // overrides what the file or its name says
    std::optional<std::uint8_t> channels; // raw files only
    unsigned threads = 0;                 // 0: all cores
    DecodeOptions decode;                 // of a .tess
    ViewHints views;                      // of folders and pictures
};

} // namespace tessera
