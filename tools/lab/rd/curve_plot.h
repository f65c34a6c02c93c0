// Curves over a logarithmic axis as an SVG picture, each with its name beside it.
#pragma once

#include <string>
#include <vector>

namespace tessera {

struct CurvePoint {
    double rate, psnr; // rate above 0
    std::string about; // shown where the mouse rests on it
};

struct PlotCurve {
    std::string id; // its name; what stands before a colon chooses the colour, the rest the dashes
    std::vector<CurvePoint> points; // by ascending rate, at least one
};

struct PlotTexts {
    std::string title, subtitle, rate_axis, psnr_axis;
};

// The first curve lies on top. Stands alone, and inside HTML.
std::string curves_to_svg(const std::vector<PlotCurve>& curves, const PlotTexts& texts);

} // namespace tessera
