// Pictures with labels, laid out in rows on one sheet.
#pragma once

#include "tools/picture/picture.h"

#include <string>
#include <vector>

namespace tessera {

// A picture with a line of text above it, cut to the picture's width.
struct Panel {
    std::string label;
    Picture picture;
};
using PanelRow = std::vector<Panel>;

constexpr std::uint64_t max_sheet_pixels = 1u << 28;

// Errors: unsupported, where the sheet would have more than that.
Result<Picture> lay_out(const std::vector<PanelRow>& rows);

} // namespace tessera
