#include "tools/lab/rd/curve_plot.h"

#include "tools/lab/rd/plot_labels.h"
#include "tools/support/html_text.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace tessera {
namespace {

constexpr double width = 1040, height = 660, left = 64, right = 28, top = 58, bottom = 58;

struct Style {
    std::string colour;
    double line = 1.6;
    std::string dash;
};

// Each family has one colour. The part of an id after the colon changes only the dashes.
Style style_of(const std::string& id, std::size_t variant) {
    static const std::map<std::string, std::string> colours = {
        {"tessera", "#c8102e"}, {"x265", "#1f5fa8"},   {"aom", "#7b4bb0"},
        {"avif", "#d96c00"},    {"jxl", "#00838f"},    {"zfp", "#5f6b73"},
        {"exr", "#b03a92"},     {"astc", "#4b6b00"},   {"svtav1", "#2a8a3e"},
        {"surface", "#c8102e"}, {"sphere", "#1f5fa8"}, {"plain", "#4b6b00"}};
    static const char* const dashes[] = {"", "7 3", "2 3", "9 3 2 3"};
    const std::string family = id.substr(0, id.find(':'));
    const auto known = colours.find(family);
    return {known == colours.end() ? "#333333" : known->second,
            family == "tessera" || family == "surface" ? 3.0 : 1.6,
            dashes[std::min<std::size_t>(variant, 3)]};
}

// One style per curve. The variants of a family differ in their dashes.
std::vector<Style> styles_of(const std::vector<PlotCurve>& all) {
    std::vector<Style> styles;
    std::map<std::string, std::size_t> variants;
    for (const PlotCurve& series : all)
        styles.push_back(style_of(series.id, variants[series.id.substr(0, series.id.find(':'))]++));
    return styles;
}

// Maps rates and PSNRs to pixel coordinates.
struct Axes {
    double low_rate, high_rate, low_psnr, high_psnr;
    double x(double rate) const {
        return left +
               std::log(rate / low_rate) / std::log(high_rate / low_rate) * (width - left - right);
    }
    double y(double psnr) const {
        return height - bottom -
               (psnr - low_psnr) / (high_psnr - low_psnr) * (height - top - bottom);
    }
};

Axes axes_for(const std::vector<PlotCurve>& all) {
    Axes axes{1e300, 0, 1e300, -1e300};
    for (const PlotCurve& series : all)
        for (const CurvePoint& p : series.points) {
            axes.low_rate = std::min(axes.low_rate, p.rate);
            axes.high_rate = std::max(axes.high_rate, p.rate);
            axes.low_psnr = std::min(axes.low_psnr, p.psnr);
            axes.high_psnr = std::max(axes.high_psnr, p.psnr);
        }
    // Leaves room for names at both ends.
    axes.low_rate /= 1.25;
    axes.high_rate *= 1.25;
    axes.low_psnr = std::floor(axes.low_psnr - 0.4);
    axes.high_psnr = std::ceil(axes.high_psnr + 0.4);
    return axes;
}

std::string px(double value) {
    return format_number(value, 1);
}

std::string text_at(double x, double y, const std::string& text, const std::string& attributes) {
    return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" " + attributes + ">" + html_text(text) +
           "</text>\n";
}

std::string line_from(double x0, double y0, double x1, double y1, const std::string& attributes) {
    return "<line x1=\"" + px(x0) + "\" y1=\"" + px(y0) + "\" x2=\"" + px(x1) + "\" y2=\"" +
           px(y1) + "\" " + attributes + "/>\n";
}

// Ticks at 1, 2 and 5 of each decade, written without needless zeros: 0.05, 2, 10k.
std::vector<std::pair<double, std::string>> rate_ticks(const Axes& axes) {
    std::vector<std::pair<double, std::string>> ticks;
    for (int decade = -6; decade <= 11; ++decade)
        for (const int first : {1, 2, 5}) {
            const double rate = first * std::pow(10.0, decade);
            const double shown = decade >= 6 ? rate / 1e6 : decade >= 3 ? rate / 1e3 : rate;
            if (rate >= axes.low_rate && rate <= axes.high_rate)
                ticks.push_back(
                    {rate, format_number(shown, std::max(0, -decade)) + (decade >= 6   ? "M"
                                                                         : decade >= 3 ? "k"
                                                                                       : "")});
        }
    return ticks;
}

std::string grid(const Axes& axes, const PlotTexts& texts) {
    std::string svg;
    const std::string grid_line = "stroke=\"#e3e6ea\" stroke-width=\"1\"";
    const std::string small = "fill=\"#4a5560\" font-size=\"12\"";
    for (const auto& [rate, label] : rate_ticks(axes)) {
        svg += line_from(axes.x(rate), top, axes.x(rate), height - bottom, grid_line);
        svg +=
            text_at(axes.x(rate), height - bottom + 18, label, small + " text-anchor=\"middle\"");
    }
    const double span = axes.high_psnr - axes.low_psnr;
    const double step = span > 30 ? 5 : span > 14 ? 2 : 1;
    for (double psnr = std::ceil(axes.low_psnr / step) * step; psnr <= axes.high_psnr;
         psnr += step) {
        svg += line_from(left, axes.y(psnr), width - right, axes.y(psnr), grid_line);
        svg += text_at(left - 8, axes.y(psnr) + 4, format_number(psnr, 0),
                       small + " text-anchor=\"end\"");
    }
    const std::string axis = "stroke=\"#8b96a1\" stroke-width=\"1\"";
    svg += line_from(left, height - bottom, width - right, height - bottom, axis);
    svg += line_from(left, top, left, height - bottom, axis);
    svg += text_at((left + width - right) / 2, height - 16, texts.rate_axis,
                   "fill=\"#222\" font-size=\"13\" text-anchor=\"middle\"");
    svg +=
        text_at(18, (top + height - bottom) / 2, texts.psnr_axis,
                "fill=\"#222\" font-size=\"13\" text-anchor=\"middle\" transform=\"rotate(-90 18 " +
                    px((top + height - bottom) / 2) + ")\"");
    return svg;
}

std::string line_of(const PlotCurve& series, const Style& style, const Axes& axes) {
    std::string svg = "<polyline fill=\"none\" stroke=\"" + style.colour + "\" stroke-width=\"" +
                      px(style.line) + "\" stroke-linejoin=\"round\"";
    if (!style.dash.empty())
        svg += " stroke-dasharray=\"" + style.dash + "\"";
    svg += " points=\"";
    for (const CurvePoint& p : series.points)
        svg += px(axes.x(p.rate)) + "," + px(axes.y(p.psnr)) + " ";
    svg += "\"/>\n";
    for (const CurvePoint& p : series.points)
        svg += "<circle cx=\"" + px(axes.x(p.rate)) + "\" cy=\"" + px(axes.y(p.psnr)) + "\" r=\"" +
               px(style.line + 1.6) + "\" fill=\"" + style.colour + "\" stroke=\"#fff\"><title>" +
               html_text(p.about) + "</title></circle>\n";
    return svg;
}

std::string labels(const std::vector<PlotCurve>& all, const std::vector<Style>& styles,
                   const Axes& axes) {
    std::vector<LabelledLine> lines;
    for (const PlotCurve& series : all) {
        LabelledLine line{series.id, {}};
        for (const CurvePoint& p : series.points)
            line.points.push_back({axes.x(p.rate), axes.y(p.psnr)});
        lines.push_back(std::move(line));
    }
    const std::vector<LabelPlace> places =
        place_labels(lines, {left + 2, top + 2, width - right - 2, height - bottom - 2});
    std::string svg;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (places[i].leader)
            svg += line_from(places[i].from.x, places[i].from.y, places[i].box.x0,
                             places[i].box.y1 - 5,
                             "stroke=\"" + styles[i].colour + "\" stroke-width=\"0.7\"");
        svg += text_at(places[i].box.x0, places[i].box.y1 - 4, all[i].id,
                       "fill=\"" + styles[i].colour +
                           "\" font-size=\"13\" font-weight=\"600\" paint-order=\"stroke\" "
                           "stroke=\"#fff\" stroke-width=\"3\"");
    }
    return svg;
}

} // namespace

std::string curves_to_svg(const std::vector<PlotCurve>& curves, const PlotTexts& texts) {
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + px(width) + " " +
                      px(height) + "\" width=\"" + px(width) + "\" height=\"" + px(height) +
                      "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n" +
                      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    svg += text_at(left, 26, texts.title, "fill=\"#111\" font-size=\"17\" font-weight=\"600\"");
    svg += text_at(left, 45, texts.subtitle, "fill=\"#4a5560\" font-size=\"12\"");
    if (curves.empty())
        return svg +
               text_at(width / 2, height / 2, "nothing was measured",
                       "fill=\"#4a5560\" font-size=\"14\" text-anchor=\"middle\"") +
               "</svg>\n";
    const std::vector<Style> styles = styles_of(curves);
    const Axes axes = axes_for(curves);
    svg += grid(axes, texts);
    for (std::size_t i = curves.size(); i-- > 0;) // draws the first curve last, on top
        svg += line_of(curves[i], styles[i], axes);
    return svg + labels(curves, styles, axes) + "</svg>\n";
}

} // namespace tessera
