#include "tools/verbs/compare_photographs.h"

#include "codec/metrics.h"
#include "corpus/photographs/photograph.h"
#include "tools/support/interrupt.h"
#include "tools/support/json_text.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using corpus::PhotoPixels;
using corpus::PosedPhotograph;

struct ComparedPhotograph {
    std::string name;
    double mse = 0;             // of codes of 8 bits
    double weight = 0;          // pixels that count
    std::optional<double> ssim; // absent where a mask leaves pixels out
    double psnr() const { return psnr_of(mse, 255); }
};

struct PhotographFigures {
    double psnr = 0, worst_psnr = 0; // mean over the photographs
    double pixel_psnr = 0;           // of the mean error of all pixels
    std::string worst;
    std::optional<double> ssim;
};

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

// A picture without a camera.
Result<PosedPhotograph> plain_photograph(const fs::path& path) {
    PosedPhotograph photograph;
    photograph.name = path.filename().string();
    photograph.path = path.string();
    TESSERA_TRY_ASSIGN(const auto file, open_file(photograph.path));
    TESSERA_TRY_ASSIGN(const auto picture, corpus::open_picture_file(*file));
    photograph.exif = corpus::Exif::followed;
    photograph.camera.width = picture->shape().width;
    photograph.camera.height = picture->shape().height;
    return photograph;
}

// All pictures of the folder, by name.
Result<std::vector<PosedPhotograph>> photographs_in(const std::string& folder) {
    std::vector<fs::path> paths;
    std::error_code failed;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed))
        if (corpus::is_picture_suffix(entry->path().extension().string()))
            paths.push_back(entry->path());
    if (failed)
        return Status(ErrorCode::io, folder + ": " + failed.message());
    if (paths.empty())
        return Status(ErrorCode::bad_argument, folder + ": has no pictures");
    std::ranges::sort(paths);
    std::vector<PosedPhotograph> photographs;
    for (const fs::path& path : paths) {
        TESSERA_TRY_ASSIGN(photographs.emplace_back(), plain_photograph(path));
    }
    return photographs;
}

Result<std::vector<PosedPhotograph>> photographs_of(const PhotographComparison& a,
                                                    Warnings& warnings) {
    if (!corpus::is_photograph_set(a.photographs))
        return photographs_in(a.photographs);
    TESSERA_TRY_ASSIGN(auto set, corpus::read_photographs(a.photographs, {.images = a.images}));
    for (const corpus::PhotographNote& note : set.notes)
        TESSERA_TRY(warnings.add(note.kind, note.place, note.count));
    return std::move(set.photographs);
}

bool is_regular(const std::string& path) {
    std::error_code none;
    return fs::is_regular_file(path, none);
}

// The drawn picture of the photograph with this short name.
Result<PosedPhotograph> drawn_picture(const std::string& folder, const std::string& name) {
    for (const char* suffix : {".png", ".exr", ".jpg", ".webp", ".tif"})
        if (const std::string path = folder + "/" + name + suffix; is_regular(path))
            return plain_photograph(path);
    return Status(ErrorCode::difference, folder + "/" + name + ".png: does not exist");
}

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

Result<ComparedPhotograph> compare_one(const PosedPhotograph& photograph, const std::string& name,
                                       const std::string& folder, const glm::dvec3& background) {
    TESSERA_TRY(check_interrupt());
    TESSERA_TRY_ASSIGN(const PosedPhotograph drawn, drawn_picture(folder, name));
    const corpus::PhotoCamera &a = photograph.camera, &b = drawn.camera;
    if (a.width != b.width || a.height != b.height)
        return Status(ErrorCode::difference, drawn.path + ": has " + std::to_string(b.width) + "x" +
                                                 std::to_string(b.height) +
                                                 " pixels, but the photograph " + photograph.path +
                                                 " has " + std::to_string(a.width) + "x" +
                                                 std::to_string(a.height));
    TESSERA_TRY_ASSIGN(const PhotoPixels seen, read_photograph(photograph, background));
    TESSERA_TRY_ASSIGN(const PhotoPixels pixels, read_photograph(drawn, background));
    ComparedPhotograph compared = compare_pixels(seen, pixels);
    compared.name = name;
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

Json finite_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json json_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json photographs_json(const PhotographComparison& a, const PhotographFigures& figures,
                      const std::vector<ComparedPhotograph>& photographs,
                      const std::vector<std::string>& missed) {
    Json json = {{"photographs", a.photographs},
                 {"drawn", a.drawn},
                 {"psnr", figures.psnr},
                 {"psnr_of_pixels", finite_or_null(figures.pixel_psnr)},
                 {"worst", {{"name", figures.worst}, {"psnr", figures.worst_psnr}}},
                 {"ssim", json_or_null(figures.ssim)}};
    for (const ComparedPhotograph& photograph : photographs)
        json["pictures"].push_back({{"name", photograph.name},
                                    {"psnr", finite_or_null(photograph.psnr())},
                                    {"ssim", json_or_null(photograph.ssim)},
                                    {"pixels", photograph.weight}});
    json["passed"] = missed.empty();
    json["missed"] = missed;
    return json;
}

std::string ssim_text(const std::optional<double>& ssim) {
    return ssim ? format_number(*ssim, 5) : "masked";
}

void print_photographs(const PhotographFigures& figures,
                       const std::vector<ComparedPhotograph>& photographs) {
    std::size_t width = 10;
    for (const ComparedPhotograph& photograph : photographs)
        width = std::max(width, photograph.name.size());
    const auto row = [width](const std::string& name, double psnr, const std::string& ssim) {
        std::printf("%-*s %9s %9s\n", static_cast<int>(width), printable(name).c_str(),
                    std::isfinite(psnr) ? format_number(psnr, 2).c_str() : "exact", ssim.c_str());
    };
    std::printf("%-*s %9s %9s\n", static_cast<int>(width), "photograph", "PSNR dB", "SSIM");
    for (const ComparedPhotograph& photograph : photographs)
        row(photograph.name, photograph.psnr(), ssim_text(photograph.ssim));
    row("mean", figures.psnr, ssim_text(figures.ssim));
    row("all pixels", figures.pixel_psnr, "");
}

std::vector<std::string> missed_means(const PhotographComparison& a,
                                      const PhotographFigures& figures) {
    std::vector<std::string> missed;
    if (a.min_psnr && figures.psnr < *a.min_psnr)
        missed.push_back("the mean PSNR " + format_number(figures.psnr, 4) + " dB is below " +
                         format_number(*a.min_psnr, 4));
    if (a.min_ssim && figures.ssim && *figures.ssim < *a.min_ssim)
        missed.push_back("the mean SSIM " + format_number(*figures.ssim, 6) + " is below " +
                         format_number(*a.min_ssim, 6));
    return missed;
}

} // namespace

bool are_photographs(const std::string& a, const std::string& b) {
    std::error_code none;
    return corpus::is_photograph_set(a) &&
           (fs::is_directory(b, none) || !fs::is_directory(a, none));
}

Status compare_photographs(const PhotographComparison& a) {
    TESSERA_TRY_ASSIGN(const glm::dvec3 background, parse_background(a.background));
    Warnings warnings(false);
    TESSERA_TRY_ASSIGN(const auto photographs, photographs_of(a, warnings));
    const std::vector<std::string> names = corpus::names_of(photographs);
    std::vector<ComparedPhotograph> compared(names.size());
    {
        Progress progress("tessera compare", a.quiet || a.json);
        const ProgressFunction show = progress.function();
        std::vector<int> workers(thread_count(a.threads));
        TESSERA_TRY(parallel_for(
            workers, names.size(),
            [&](int, std::size_t i) -> Status {
                TESSERA_TRY_ASSIGN(compared[i],
                                   compare_one(photographs[i], names[i], a.drawn, background));
                return {};
            },
            [&](std::size_t done) {
                if (show)
                    show("comparing", static_cast<double>(done), static_cast<double>(names.size()));
            }));
    }
    const PhotographFigures figures = figures_of(compared);
    if (a.min_ssim && !figures.ssim)
        return {ErrorCode::unsupported, "--min-ssim: there is no SSIM of masked photographs"};
    const auto missed = missed_means(a, figures);
    warnings.print("compare");
    if (a.json)
        print_json(photographs_json(a, figures, compared, missed));
    else if (!a.quiet)
        print_photographs(figures, compared);
    if (missed.empty())
        return {};
    return {ErrorCode::difference,
            a.drawn + ": " + missed.front() + (missed.size() > 1 ? "; " + missed.back() : "")};
}

} // namespace tessera
