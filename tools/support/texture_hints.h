// What the command line states about an input, for files that do not describe themselves.
#pragma once

#include "codec/decoder.h" // DecodeOptions
#include "corpus/picture_file.h"
#include "format/texture.h"
#include "tools/support/view_order.h"
#include "tools/support/warnings.h"

#include <cstdint>
#include <optional>
#include <string>

namespace tessera {

// How the colours of a film become RGB.
enum class YuvMatrix { bt601, bt709 };

// Names and layout of pictures with views.
struct ViewHints {
    std::string pattern;            // of file names, see view_pattern.h; empty: detected
    std::optional<ViewGrid> grid;   // of the cameras
    std::optional<ViewGrid> quilt;  // views in columns x rows of one picture
    std::optional<ViewGrid> mosaic; // angular images of s x t pixels, side by side in one picture
    std::optional<ViewOrder> order; // of the views of a folder, a quilt or a film
    corpus::Exif exif = corpus::Exif::followed;
    std::string layer;                   // of EXR pictures; see corpus::PictureOptions
    std::optional<YuvMatrix> yuv_matrix; // of films
};

struct TextureHints {
    std::optional<Extent4> size;          // raw files and EXR mosaics of other programs need it
    std::optional<SampleType> type;       // overrides the file and its name
    std::optional<std::uint8_t> channels; // raw files only
    unsigned threads = 0;                 // 0: all cores
    DecodeOptions decode;                 // of a .tess
    ViewHints views;                      // of folders and pictures
    Warnings* warnings = nullptr;         // receives those of pictures; outlives their source
};

} // namespace tessera
