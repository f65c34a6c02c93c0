#include "tools/view/view_report.h"

#include "codec/metrics.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double amplification = 8;

std::vector<float> luma_of(const Picture& p) {
    std::vector<float> luma(p.rgb.size() / 3);
    for (std::size_t i = 0; i < luma.size(); ++i) {
        const auto value = [&](std::size_t c) {
            return static_cast<float>(std::to_integer<int>(p.rgb[3 * i + c]));
        };
        luma[i] = 0.2126f * value(0) + 0.7152f * value(1) + 0.0722f * value(2);
    }
    return luma;
}

std::optional<Likeness> likeness_of_both(const std::optional<Picture>& a,
                                         const std::optional<Picture>& b) {
    if (!a || !b)
        return std::nullopt;
    return likeness_of(*a, *b);
}

struct ReportColumn {
    const char* title;
    const char* key;
    std::optional<Likeness> ViewFigures::*figures;
};
const ReportColumn columns[] = {
    {"compressed/truth", "compressed_truth", &ViewFigures::compressed_truth},
    {"uncompressed/truth", "uncompressed_truth", &ViewFigures::uncompressed_truth},
    {"compressed/uncompressed", "compressed_uncompressed", &ViewFigures::compressed_uncompressed}};

Json number_or_null(double x) {
    return std::isfinite(x) ? Json(x) : Json(nullptr);
}

std::string pad_left(const std::string& text, std::size_t width) {
    return std::string(width - std::min(width, text.size()), ' ') + text;
}

std::string pad_right(const std::string& text, std::size_t width) {
    return text + std::string(width - std::min(width, text.size()), ' ');
}

} // namespace

Likeness likeness_of(const Picture& a, const Picture& b) {
    double squares = 0, object_samples = 0;
    const auto shows_background = [&](const Picture& p, std::size_t pixel) {
        return std::equal(a.rgb.begin(), a.rgb.begin() + 3,
                          p.rgb.begin() + static_cast<std::ptrdiff_t>(pixel));
    };
    for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
        if (shows_background(a, i) && shows_background(b, i))
            continue; // no error
        object_samples += 3;
        for (std::size_t c = 0; c < 3; ++c) {
            const double d =
                std::to_integer<int>(a.rgb[i + c]) - std::to_integer<int>(b.rgb[i + c]);
            squares += d * d;
        }
    }
    return {psnr_of(squares / static_cast<double>(a.rgb.size()), 255),
            psnr_of(squares / std::max(object_samples, 1.0), 255),
            ssim(luma_of(a), luma_of(b), a.width, a.height, 255)};
}

ViewFigures measure(const ViewPictures& p) {
    return {p.name, likeness_of_both(p.truth, p.compressed),
            likeness_of_both(p.truth, p.uncompressed),
            likeness_of_both(p.uncompressed, p.compressed)};
}

std::string to_table(const std::vector<ViewFigures>& views) {
    std::size_t name_width = 4, column_width = 25;
    for (const ViewFigures& view : views)
        name_width = std::max(name_width, view.name.size());
    std::string titles = pad_right("view", name_width), units = pad_right("", name_width);
    std::string lines;
    for (const ReportColumn& column : columns)
        if (!views.empty() && views.front().*column.figures) {
            titles += pad_left(column.title, column_width);
            units += pad_left("PSNR dB    SSIM", column_width);
        }
    for (const ViewFigures& view : views) {
        lines += pad_right(view.name, name_width);
        for (const ReportColumn& column : columns)
            if (const std::optional<Likeness>& l = view.*column.figures) {
                const std::string psnr =
                    std::isfinite(l->psnr) ? format_number(l->psnr, 2) : "same";
                lines += pad_left(psnr + pad_left(format_number(l->ssim, 4), 8), column_width);
            }
        lines += '\n';
    }
    return titles + '\n' + units + '\n' + lines;
}

Json to_json(const ViewFigures& figures) {
    Json json = Json::object();
    for (const ReportColumn& column : columns)
        if (const std::optional<Likeness>& l = figures.*column.figures)
            json[column.key] = {{"psnr", number_or_null(l->psnr)},
                                {"object_psnr", number_or_null(l->object_psnr)},
                                {"ssim", l->ssim}};
    return json;
}

PanelRow to_panels(const ViewPictures& p) {
    PanelRow row;
    const auto add = [&](const char* label, const std::optional<Picture>& picture) {
        if (picture)
            row.push_back({p.name + (p.name.empty() ? "" : ": ") + label, *picture});
    };
    add("truth", p.truth);
    add("uncompressed", p.uncompressed);
    add("compressed", p.compressed);
    if (p.uncompressed && p.compressed)
        row.push_back({"difference compressed - uncompressed x " + format_number(amplification, 0),
                       difference_of(*p.uncompressed, *p.compressed, amplification)});
    return row;
}

} // namespace tessera
