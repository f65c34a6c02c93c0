// How a picture must be turned to stand upright, as cameras state it in EXIF metadata.
#pragma once

#include "corpus/picture_file.h"

namespace tessera::corpus {

// The values of the EXIF tag Orientation: where the first row and the first column of the file
// belong.
enum class Orientation : std::uint8_t {
    top_left = 1,
    top_right,
    bottom_right,
    bottom_left,
    left_top,
    right_top,
    right_bottom,
    left_bottom
};

// Of the content of a JPEG's APP1 segment. top_left if it is not EXIF, states no orientation, or is
// damaged.
Orientation exif_orientation(std::span<const std::byte> segment);

// The picture turned upright. Each read holds all of it in memory. Errors: unsupported (larger than
// 1 GiB).
std::unique_ptr<PictureReader> turned(std::unique_ptr<PictureReader> picture,
                                      Orientation orientation);

} // namespace tessera::corpus
