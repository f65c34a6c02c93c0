// One picture to look at: some views and angular images of a texture, beside those of a second one
// and the difference.
#pragma once

#include "format/texture.h"
#include "tools/picture/picture.h"

#include <string>

namespace tessera {

struct SheetOptions {
    unsigned views = 3, angular_images = 8; // how many of each
    double amplify = 8;                     // of the difference
    std::string name_a = "A", name_b = "B";
};

// `b` may be null: then there is nothing to compare. Grey shows as grey, alpha not at all; half
// floats as sRGB of x / (1 + x). v grows upwards in the texture and so in the pictures, t likewise.
// Errors: difference where size, type or channels differ; unsupported where a view is larger than
// 8192 a side; those of the sources.
Result<Picture> make_contact_sheet(TexelSource& a, TexelSource* b, const SheetOptions& options);

} // namespace tessera
