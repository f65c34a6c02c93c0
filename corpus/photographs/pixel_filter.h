// How a picture's pixels weigh the light around their centres.
#pragma once

#include "format/status.h"

#include <string_view>
#include <vector>

namespace tessera::corpus {

// A filter that is the product of the same function along x and y. Immutable and thread-safe.
class PixelFilter {
public:
    // The square of the pixel itself.
    PixelFilter() = default;
    // "box", "gauss" or "blackman-harris", also with a width, "gauss:2.5": how far the filter
    // reaches in all, 0.01 to 100 pixels. By default 1 for the box, and for the others what Blender's
    // Cycles makes of its usual width of 1.5: 4.5 for gauss, 3 for blackman-harris. Errors: bad_argument, with the text.
    static Result<PixelFilter> parse(std::string_view text);

    // Where a ray crosses the picture, in pixels from the left or upper side of its pixel. If `u` is
    // evenly distributed in 0..1, places are distributed as the filter weighs them; 0.5 gives the
    // centre.
    double place(double u) const;
    double width() const { return width_; } // pixels
    bool is_default() const { return width_ == 1 && places_.empty(); }

private:
    PixelFilter(double width, std::vector<double> places)
        : width_(width), places_(std::move(places)) {}

    double width_ = 1;
    // Offsets from the centre, in widths, for even steps of u from 0 to 1. Empty: a box.
    std::vector<double> places_;
};

} // namespace tessera::corpus
