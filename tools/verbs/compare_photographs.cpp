#include "tools/verbs/compare_photographs.h"

#include "codec/metrics.h"
#include "corpus/photographs/photograph.h"
#include "format/output_file.h"
#include "tools/support/interrupt.h"
#include "tools/support/json_text.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/warnings.h"
#include "tools/verbs/photograph_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

namespace fs = std::filesystem;
using corpus::PhotoPixels;
using corpus::PosedPhotograph;

// A picture without a camera.
Result<PosedPhotograph> plain_photograph(const std::string& folder, const std::string& name) {
    PosedPhotograph photograph;
    photograph.name = name;
    photograph.path = folder + "/" + name;
    TESSERA_TRY_ASSIGN(const auto file, open_file(photograph.path));
    TESSERA_TRY_ASSIGN(const auto picture, corpus::open_picture_file(*file));
    photograph.exif = corpus::Exif::followed;
    photograph.camera.width = picture->shape().width;
    photograph.camera.height = picture->shape().height;
    return photograph;
}

// All pictures of the folder, by name.
Result<std::vector<PosedPhotograph>> photographs_in(const std::string& folder) {
    std::error_code failed;
    std::vector<std::string> names = names_in(folder, failed);
    std::erase_if(names, [](const std::string& name) {
        return !corpus::is_picture_suffix(to_path(name).extension().string());
    });
    if (failed)
        return Status(ErrorCode::io, folder + ": " + failed.message());
    if (names.empty())
        return Status(ErrorCode::bad_argument, folder + ": has no pictures");
    std::ranges::sort(names);
    std::vector<PosedPhotograph> photographs;
    for (const std::string& name : names) {
        TESSERA_TRY_ASSIGN(photographs.emplace_back(), plain_photograph(folder, name));
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
    return fs::is_regular_file(to_path(path), none);
}

// The drawn picture of the photograph with this short name.
Result<PosedPhotograph> drawn_picture(const std::string& folder, const std::string& name) {
    for (const char* suffix : {".png", ".exr", ".jpg", ".webp", ".tif"})
        if (const std::string path = folder + "/" + name + suffix; is_regular(path))
            return plain_photograph(folder, name + suffix);
    return Status(ErrorCode::difference, folder + "/" + name + ".png: does not exist");
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

Json finite_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json json_or_null(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json photographs_json(const PhotographComparison& a, const PhotographFigures& figures,
                      const std::vector<ComparedPhotograph>& photographs,
                      const std::vector<std::string>& missed, const Warnings& warnings) {
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
    json["warnings"] = warnings.json();
    return json;
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
           (fs::is_directory(to_path(b), none) || !fs::is_directory(to_path(a), none));
}

Status compare_photographs(const PhotographComparison& a) {
    TESSERA_TRY_ASSIGN(const glm::dvec3 background, parse_background(a.background));
    Warnings warnings(a.strict);
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
        print_json(photographs_json(a, figures, compared, missed, warnings));
    else if (!a.quiet)
        print_photographs("photograph", figures, compared);
    if (missed.empty())
        return {};
    return {ErrorCode::difference,
            a.drawn + ": " + missed.front() + (missed.size() > 1 ? "; " + missed.back() : "")};
}

} // namespace tessera
