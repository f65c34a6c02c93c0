// Rate-distortion curves as an SVG picture: PSNR over the logarithm of the rate, a line per codec
// with its name beside it.
#pragma once

#include "tools/lab/rd/curve_plot.h"
#include "tools/lab/rd/report.h"

#include <string>

namespace tessera {

enum class PlotPart {
    whole,
    close_up, // where the best codecs are: rates up to six times the least for about speed_psnr
};

// Of PSNR-RGB. Lossless points and codecs that are not for the plot are left out. Stands alone, and
// inside HTML. Empty for a close-up that would show all points there are.
std::string to_svg(const TextureReport& texture, PlotPart part = PlotPart::whole);

} // namespace tessera
