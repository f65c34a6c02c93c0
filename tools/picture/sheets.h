// Sheets: one picture that shows parts of textures, or several pictures side by side.
#pragma once

#include "format/texture.h"
#include "tools/picture/picture.h"

#include <span>
#include <string>
#include <vector>

namespace tessera {

struct SheetOptions {
    unsigned views = 3, angular_images = 8; // how many of each
    double amplify = 8;                     // factor of the difference
    std::string name_a = "A", name_b = "B"; // of the textures, for labels
};

// Shows views and angular images of `a`; if `b` is not null, also those of `b` and the differences.
// v and t grow upwards. Grey becomes RGB, alpha is not shown, half floats are shown as sRGB of x /
// (1 + x). Errors: difference (another size, type or number of channels), unsupported (an extent
// above 8192), those of the sources.
Result<Picture> make_contact_sheet(TexelSource& a, TexelSource* b, const SheetOptions& options);

struct GridOptions {
    unsigned columns = 4;
    unsigned middle = 0;             // side in pixels of the middle part that is shown; 0: all
    std::vector<std::string> labels; // one per picture; empty: the names of the files
};

// Shows the pictures of PNG files, row by row. Errors: bad_argument (another number of labels than
// of pictures), those of read_png() and lay_out().
Result<Picture> make_picture_grid(std::span<const std::string> paths, const GridOptions& options);

} // namespace tessera
