#include "tools/lab/rd/plot.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

std::vector<PlotCurve> curves_of(const TextureReport& texture) {
    std::vector<PlotCurve> all;
    for (const CodecInfo& info : texture.codecs) {
        if (!info.in_plot)
            continue;
        PlotCurve series{info.id, {}};
        for (const Measurement& m : texture.rows)
            if (m.codec == info.id && m.failed.empty() && std::isfinite(m.quality.psnr_rgb))
                series.points.push_back({m.bits_per_texel, m.quality.psnr_rgb,
                                         m.codec + ", " + m.setting + ": " +
                                             format_number(m.bits_per_texel, 4) + " bpt, " +
                                             format_number(m.quality.psnr_rgb, 2) + " dB"});
        if (series.points.empty())
            continue;
        std::sort(series.points.begin(), series.points.end(),
                  [](const CurvePoint& a, const CurvePoint& b) { return a.rate < b.rate; });
        all.push_back(std::move(series));
    }
    return all;
}

// Keeps only the points of the close-up. Returns whether it removed any and a curve is left.
bool keep_close_up(std::vector<PlotCurve>& all) {
    double least = std::numeric_limits<double>::infinity();
    for (const PlotCurve& series : all)
        for (const CurvePoint& p : series.points)
            if (p.psnr >= speed_psnr - 1)
                least = std::min(least, p.rate);
    std::size_t gone = 0;
    for (PlotCurve& series : all)
        gone += std::erase_if(series.points, [&](const CurvePoint& p) {
            return p.rate > 6 * least || p.psnr < speed_psnr - 6;
        });
    std::erase_if(all, [](const PlotCurve& series) { return series.points.size() < 2; });
    return gone > 0 && !all.empty();
}

} // namespace

std::string to_svg(const TextureReport& texture, PlotPart part) {
    std::vector<PlotCurve> all = curves_of(texture);
    if (part == PlotPart::close_up && !keep_close_up(all))
        return "";
    return curves_to_svg(
        all, {texture.name + ", " + texture.size + (part == PlotPart::close_up ? ", close up" : ""),
              (texture.crop.empty() ? "" : "A crop, " + texture.crop + ". ") +
                  "Up and to the left is better. Every point was decoded and measured.",
              "bits per texel (logarithmic)", "PSNR of RGB, dB"});
}

} // namespace tessera
