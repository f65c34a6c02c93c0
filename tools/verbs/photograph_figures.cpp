#include "tools/verbs/photograph_figures.h"

#include "tools/support/parse.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tessera {
namespace {

using corpus::PhotoPixels;

float photo_code(float value) {
    return std::round(255 * value);
}

// BT.709 luma of the codes, as in ErrorSums.
std::vector<float> photo_luma(const PhotoPixels& pixels) {
    std::vector<float> luma;
    luma.reserve(pixels.texels.size());
    for (const auto& [r, g, b, weight] : pixels.texels)
        luma.push_back(0.2126f * photo_code(r) + 0.7152f * photo_code(g) + 0.0722f * photo_code(b));
    return luma;
}

std::string ssim_text(const std::optional<double>& ssim) {
    return ssim ? format_number(*ssim, 5) : "masked";
}

} // namespace

Result<glm::dvec3> parse_background(const std::string& text) {
    if (text.empty() || text == "black")
        return glm::dvec3(0.0);
    if (text == "white")
        return glm::dvec3(1.0);
    double numbers[3];
    if (!parse_numbers(text, numbers) ||
        !std::ranges::all_of(numbers, [](double x) { return x >= 0 && x <= 1; }))
        return Status(ErrorCode::bad_argument, "--background '" + text +
                                                   "' is neither white nor black nor three numbers "
                                                   "from 0 to 1, such as 0.5,0.5,0.5");
    return glm::dvec3(numbers[0], numbers[1], numbers[2]);
}

ComparedPhotograph compare_pixels(const PhotoPixels& photograph, const PhotoPixels& drawn) {
    ComparedPhotograph compared;
    double squares = 0;
    bool is_masked = false;
    for (std::size_t i = 0; i < photograph.texels.size(); ++i) {
        const double weight = static_cast<double>(photograph.texels[i][3]);
        is_masked = is_masked || weight < 1;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto error = static_cast<double>(photo_code(photograph.texels[i][c]) -
                                                   photo_code(drawn.texels[i][c]));
            squares += weight * error * error;
        }
        compared.weight += weight;
    }
    compared.mse = compared.weight > 0 ? squares / (3 * compared.weight) : 0;
    if (!is_masked)
        compared.ssim = ssim(photo_luma(photograph), photo_luma(drawn), photograph.width,
                             photograph.height, 255);
    return compared;
}

// Identical pictures have no PSNR; they count as 100 dB in the mean.
PhotographFigures figures_of(const std::vector<ComparedPhotograph>& photographs) {
    constexpr double most_psnr = 100;
    PhotographFigures figures;
    figures.worst_psnr = most_psnr + 1;
    double psnr = 0, ssim = 0, squares = 0, weight = 0;
    bool has_ssim = true;
    for (const ComparedPhotograph& photograph : photographs) {
        const double own = std::min(photograph.psnr(), most_psnr);
        psnr += own;
        squares += photograph.mse * photograph.weight;
        weight += photograph.weight;
        has_ssim = has_ssim && photograph.ssim;
        ssim += photograph.ssim.value_or(0);
        if (own < figures.worst_psnr) {
            figures.worst_psnr = own;
            figures.worst = photograph.name;
        }
    }
    const auto count = static_cast<double>(photographs.size());
    figures.psnr = psnr / count;
    figures.pixel_psnr = psnr_of(weight > 0 ? squares / weight : 0, 255);
    if (has_ssim)
        figures.ssim = ssim / count;
    return figures;
}

void print_photographs(const char* heading, const PhotographFigures& figures,
                       const std::vector<ComparedPhotograph>& photographs) {
    std::size_t width = 10;
    for (const ComparedPhotograph& photograph : photographs)
        width = std::max(width, photograph.name.size());
    const auto row = [width](const std::string& name, double psnr, const std::string& ssim) {
        std::printf("%-*s %9s %9s\n", static_cast<int>(width), printable(name).c_str(),
                    std::isfinite(psnr) ? format_number(psnr, 2).c_str() : "exact", ssim.c_str());
    };
    std::printf("%-*s %9s %9s\n", static_cast<int>(width), heading, "PSNR dB", "SSIM");
    for (const ComparedPhotograph& photograph : photographs)
        row(photograph.name, photograph.psnr(), ssim_text(photograph.ssim));
    row("mean", figures.psnr, ssim_text(figures.ssim));
    row("all pixels", figures.pixel_psnr, "");
}

} // namespace tessera
