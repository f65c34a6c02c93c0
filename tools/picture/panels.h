// Labelled pictures, laid out in rows on one sheet.
#pragma once

#include "tools/picture/picture.h"

#include <string>
#include <vector>

namespace tessera {

// A picture with a line of text above it, which is cut to the picture's width.
struct Panel {
    std::string label;
    Picture picture;
};
using PanelRow = std::vector<Panel>;

// Errors: unsupported, where the sheet would have more than max_sheet_pixels.
Result<Picture> lay_out(const std::vector<PanelRow>& rows);

} // namespace tessera
