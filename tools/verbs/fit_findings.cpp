#include "tools/verbs/fit_arguments.h"

#include "tools/support/interrupt.h"
#include "tools/support/parse.h"
#include "tools/verbs/bake_sources.h"
#include "tools/view/render_stage.h"
#include "tools/view/render_views.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tessera {
namespace {

using corpus::PosedPhotograph;

std::string text_of(const std::optional<glm::dvec3>& colour) {
    if (!colour)
        return "varies";
    return format_number(colour->x, 3) + "," + format_number(colour->y, 3) + "," +
           format_number(colour->z, 3);
}

// The drawn view as 8-bit codes, which is what `tessera render` writes.
corpus::PhotoPixels codes_of(const View& view) {
    corpus::PhotoPixels pixels{view.width, view.height, {}};
    pixels.texels.resize(std::size_t{view.width} * view.height);
    for (std::size_t i = 0; i < pixels.texels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            pixels.texels[i][c] =
                std::round(255.0f * std::clamp(view.rgb[3 * i + c], 0.0f, 1.0f)) / 255.0f;
    return pixels;
}

Json figures_json(const std::vector<ComparedPhotograph>& photographs) {
    const PhotographFigures figures = figures_of(photographs);
    Json json = {{"psnr", figures.psnr}, {"psnr_of_pixels", figures.pixel_psnr}};
    if (figures.ssim)
        json["ssim"] = *figures.ssim;
    for (const ComparedPhotograph& photograph : photographs)
        json["pictures"].push_back({{"name", photograph.name}, {"psnr", photograph.psnr()}});
    return json;
}

// What the fit found out about each photograph.
Json pictures_json(const corpus::PhotoFindings& found,
                   std::span<const PosedPhotograph> photographs) {
    Json pictures = Json::array();
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        const corpus::PhotoDifference& d = found.differences[i];
        pictures.push_back({{"name", photographs[i].name},
                            {"error", d.error},
                            {"gain", d.gain},
                            {"shift", {d.shift.x, d.shift.y}},
                            {"left_out", std::ranges::count(found.left_out, i) > 0}});
    }
    return pictures;
}

} // namespace

Status set_solve_options(const FitCommand& a, corpus::PhotoSolveOptions& options) {
    options.smoothness = a.smoothness.value_or(options.smoothness);
    options.corrects = !a.no_corrections;
    if (!a.pixel_filter.empty()) {
        TESSERA_TRY_ASSIGN(
            options.filter,
            corpus::PixelFilter::parse(a.pixel_filter).with_context("--pixel-filter"));
    }
    if (!a.background.empty()) {
        TESSERA_TRY_ASSIGN(options.background, parse_background(a.background));
    }
    options.run.threads = a.texture.threads;
    options.run.cancelled = [] { return interrupted_by() != 0; };
    return {};
}

Metadata fit_metadata(const FitCommand& a, const corpus::PhotoFindings& found,
                      std::size_t photographs,
                      std::vector<std::pair<std::string, std::string>> facts) {
    facts.emplace_back("photographs", a.photographs);
    facts.emplace_back("number of photographs", std::to_string(photographs));
    facts.emplace_back("smoothness", format_number(found.smoothness, 3));
    if (found.background) // what renderers show around the surface
        facts.emplace_back("background", text_of(found.background));
    return metadata_of(facts);
}

Status add_fit_warnings(const corpus::PhotoFindings& found,
                        std::span<const PosedPhotograph> photographs, Warnings& warnings) {
    for (const std::size_t i : found.left_out)
        TESSERA_TRY(warnings.add("photographs that fit none of the others are left out",
                                 photographs[i].name));
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        const glm::dvec2& shift = found.differences[i].shift;
        if (std::max(std::abs(shift.x), std::abs(shift.y)) > 0.0)
            TESSERA_TRY(warnings.add("photographs are moved by a fraction of a pixel to where the "
                                     "others show the object",
                                     photographs[i].name));
    }
    return {};
}

Result<std::vector<ComparedPhotograph>> measure_fit(const FitCommand& a,
                                                    const corpus::PhotoFindings& found,
                                                    std::span<const PosedPhotograph> photographs,
                                                    const corpus::PixelFilter& filter,
                                                    const ProgressFunction& show) {
    constexpr unsigned rays = 16; // per pixel
    StageRequest request;
    request.file = a.output;
    request.rays = rays;
    RenderOptions options;
    options.threads = a.texture.threads;
    options.filter = filter;
    TESSERA_TRY_ASSIGN(const Stage stage, set_up_stage(request, options));
    const std::vector<std::string> names = corpus::names_of(photographs);
    std::vector<ComparedPhotograph> compared;
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        TESSERA_TRY(check_interrupt());
        TESSERA_TRY_ASSIGN(const View view, stage.subject().render(stage.in_texture(
                                                make_camera(photographs[i].camera))));
        TESSERA_TRY_ASSIGN(
            const corpus::PhotoPixels seen,
            read_photograph(photographs[i], found.background.value_or(glm::dvec3(0.0))));
        compared.push_back(compare_pixels(seen, codes_of(view)));
        compared.back().name = names[i];
        if (show)
            show("measuring", static_cast<double>(i + 1), static_cast<double>(photographs.size()));
    }
    return compared;
}

void add_fit_findings(const corpus::PhotoFindings& found,
                      std::span<const PosedPhotograph> photographs,
                      const std::vector<ComparedPhotograph>& held_out, Json& json) {
    json["photographs"] = photographs.size() - found.left_out.size();
    json["pictures"] = pictures_json(found, photographs);
    json["fitted_pixels"] = found.pixels;
    json["background"] = text_of(found.background);
    json["smoothness"] = found.smoothness;
    json["error"] = found.error;
    if (!held_out.empty())
        json["held_out"] = figures_json(held_out);
}

void print_fit_findings(const corpus::PhotoFindings& found, std::size_t photographs,
                        const char* surface) {
    std::printf("  %zu photographs, %zu pixels that see the %s; background %s; smoothness %s\n",
                photographs - found.left_out.size(), found.pixels, surface,
                text_of(found.background).c_str(), format_number(found.smoothness, 3).c_str());
    std::printf("  the fit differs from its photographs by %s dB before it is coded\n",
                format_number(-20 * std::log10(std::max(found.error, 1e-5)), 2).c_str());
}

} // namespace tessera
