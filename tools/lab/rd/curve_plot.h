// Draws curves over a logarithmic axis as SVG, each with its name beside it.
#pragma once

#include <string>
#include <vector>

namespace tessera {

struct CurvePoint {
    double rate, psnr; // rate above 0
    std::string about; // tooltip
};

struct PlotCurve {
    std::string id; // name; the part before a colon selects the colour, the rest the dashes
    std::vector<CurvePoint> points; // by ascending rate, at least one
};

struct PlotTexts {
    std::string title, subtitle, rate_axis, psnr_axis;
};

// The first curve is drawn on top. The result is a complete SVG file that HTML can also embed.
std::string curves_to_svg(const std::vector<PlotCurve>& curves, const PlotTexts& texts);

} // namespace tessera
