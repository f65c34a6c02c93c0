// Rate-distortion curves as SVG: PSNR over the logarithm of the rate, one labelled line per codec.
#pragma once

#include "tools/lab/rd/curve_plot.h"
#include "tools/lab/rd/report.h"

#include <string>

namespace tessera {

enum class PlotPart {
    whole,
    close_up, // rates up to six times the lowest that reaches about speed_psnr
};

// Plots PSNR of RGB, without lossless points and without codecs whose `in_plot` is false. The
// result is a complete SVG file that HTML can also embed. It is empty for a close-up that would
// show the whole plot.
std::string to_svg(const TextureReport& texture, PlotPart part = PlotPart::whole);

} // namespace tessera
