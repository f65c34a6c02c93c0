// Figures on rendered views, as a table, as JSON and as a sheet to look at.
#pragma once

#include "tools/picture/panels.h"
#include "tools/picture/picture.h"
#include "tools/support/json_text.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// Of two pictures as displayed, 8-bit, background and all.
struct Likeness {
    double psnr = 0; // dB over the samples, peak 255; infinite for equal pictures
    double ssim = 0; // of luma (BT.709 weights on code values)
};
// Precondition: both have the same size.
Likeness likeness_of(const Picture& a, const Picture& b);

// One view, drawn in up to three ways.
struct ViewPictures {
    std::string name;
    std::optional<Picture> truth, uncompressed, compressed;
};

// What is measured against what. Absent where a picture is.
struct ViewFigures {
    std::string name;
    std::optional<Likeness> compressed_truth, uncompressed_truth, compressed_uncompressed;
    bool empty() const {
        return !compressed_truth && !uncompressed_truth && !compressed_uncompressed;
    }
};
ViewFigures measure(const ViewPictures& pictures);

// A line per view under a heading; only the columns that the first view has.
std::string to_table(const std::vector<ViewFigures>& views);
Json to_json(const ViewFigures& figures); // null PSNR: equal pictures

// The view's pictures side by side, and the amplified difference of compressed and uncompressed.
PanelRow to_panels(const ViewPictures& pictures);

} // namespace tessera
