// Reports the quality of rendered views as a table, as JSON and as a sheet of pictures.
#pragma once

#include "tools/picture/panels.h"
#include "tools/picture/picture.h"
#include "tools/support/json_text.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

// The similarity of two 8-bit pictures as displayed, including the background.
struct Likeness {
    double psnr = 0; // dB over all samples, with peak 255; infinite for equal pictures
    // The same over the pixels that do not show the background: those where one of the pictures
    // differs from the top left pixel of the first.
    double object_psnr = 0;
    double ssim = 0; // of luma, computed from code values with the BT.709 weights
};
// Precondition: both have the same size.
Likeness likeness_of(const Picture& a, const Picture& b);

// One view, rendered in up to three ways.
struct ViewPictures {
    std::string name;
    std::optional<Picture> truth, uncompressed, compressed;
};

// Comparisons of the pictures of one view. A comparison is absent if one of its pictures is.
struct ViewFigures {
    std::string name;
    std::optional<Likeness> compressed_truth, uncompressed_truth, compressed_uncompressed;
    bool empty() const {
        return !compressed_truth && !uncompressed_truth && !compressed_uncompressed;
    }
};
ViewFigures measure(const ViewPictures& pictures);

// A table with one line per view. It has the columns of the first view.
std::string to_table(const std::vector<ViewFigures>& views);
// The PSNR of equal pictures is null.
Json to_json(const ViewFigures& figures);

// The pictures of the view, and the amplified difference between compressed and uncompressed.
PanelRow to_panels(const ViewPictures& pictures);

} // namespace tessera
