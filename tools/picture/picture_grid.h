// Pictures from PNG files, row by row on one sheet.
#pragma once

#include "tools/picture/picture.h"

#include <span>
#include <string>
#include <vector>

namespace tessera {

struct GridOptions {
    unsigned columns = 4;
    unsigned middle = 0; // only the middle of each, so many pixels wide and high; 0: all
    std::vector<std::string> labels; // one a picture; none: the files' names
};

// Errors: bad_argument (another number of labels than of pictures), unsupported (not 8-bit RGB, too
// large), io, invalid_file.
Result<Picture> make_picture_grid(std::span<const std::string> paths, const GridOptions& options);

} // namespace tessera
