#include "corpus/fit/photo_fit.h"
#include "corpus/trace/ray_model.h"
#include "tools/support/encode_arguments.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/support/warnings.h"
#include "tools/verbs/bake_sources.h"
#include "tools/verbs/command.h"
#include "tools/verbs/encode_layers.h"
#include "tools/verbs/photograph_figures.h"
#include "tools/view/render_stage.h"
#include "tools/view/render_views.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace tessera {
namespace {

using corpus::PosedPhotograph;

struct FitCommand {
    std::string photographs, mesh, output;
    std::string images, background, pixel_filter;
    std::optional<unsigned> hold_out;
    std::optional<double> density, texels, smoothness;
    std::optional<unsigned> directions, shared_directions, cell;
    bool y_up = false, no_corrections = false;
    TextureArguments texture; // threads and quiet
    EncodeArguments encode;
};

// The photographs that are fitted, and those that are kept out to measure the fit.
struct SplitPhotographs {
    std::vector<PosedPhotograph> fitted, held_out;
};

SplitPhotographs split(std::vector<PosedPhotograph> all, std::optional<unsigned> hold_out) {
    SplitPhotographs parts;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool out = hold_out && i % *hold_out == *hold_out - 1;
        (out ? parts.held_out : parts.fitted).push_back(std::move(all[i]));
    }
    return parts;
}

Status check_fit(const FitCommand& a) {
    if (a.photographs.empty() || a.mesh.empty() || a.output.empty())
        return {ErrorCode::bad_argument, "PHOTOS, --mesh MODEL and -o OUTPUT.tess are needed"};
    if (!corpus::is_model_path(a.mesh))
        return {ErrorCode::bad_argument,
                "--mesh " + a.mesh + ": not a .gltf, .glb, .obj or .ply model"};
    for (const auto& [option, given] :
         {std::pair("--target-psnr", a.encode.target_psnr.has_value()),
          std::pair("--target-bpt", a.encode.target_bpt.has_value()),
          std::pair("--max-error", a.encode.max_error.has_value()),
          std::pair("--lossless", a.encode.lossless)})
        if (given)
            return {ErrorCode::bad_argument,
                    std::string(option) +
                        ": does not apply to the layers of a fit; use --quality or --target-bytes"};
    return check_tess_output(a.encode, a.output);
}

// The model where its file places it, or turned from y up to z up.
Result<corpus::Model> load_mesh(const FitCommand& a) {
    TESSERA_TRY_ASSIGN(corpus::Model model, corpus::load_model(a.mesh));
    corpus::restore_placement(model);
    if (a.y_up)
        for (corpus::ModelVertex& vertex : model.vertices) {
            const auto turn = [](const glm::vec3& v) { return glm::vec3(v.x, -v.z, v.y); };
            vertex.position = turn(vertex.position);
            vertex.normal = turn(vertex.normal);
        }
    return corpus::with_both_sides(std::move(model)).with_context(a.mesh);
}

Result<corpus::PhotoFitOptions> fit_options(const FitCommand& a) {
    corpus::PhotoFitOptions options;
    options.density = a.density.value_or(options.density);
    options.most_texels = a.texels.value_or(options.most_texels);
    options.smoothness = a.smoothness.value_or(options.smoothness);
    options.directions = a.directions.value_or(options.directions);
    options.shared_directions = a.shared_directions.value_or(options.shared_directions);
    options.cell = a.cell.value_or(options.cell);
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
    return options;
}

std::string text_of(const std::optional<glm::dvec3>& colour) {
    if (!colour)
        return "varies";
    return format_number(colour->x, 3) + "," + format_number(colour->y, 3) + "," +
           format_number(colour->z, 3);
}

Metadata fit_metadata(const FitCommand& a, const corpus::PhotoFit& fit, std::size_t photographs) {
    std::vector<std::pair<std::string, std::string>> facts = {
        {"photographs", a.photographs},
        {"model", a.mesh},
        {"number of photographs", std::to_string(photographs)},
        {"smoothness", format_number(fit.smoothness, 3)},
        {"texels per unit", format_number(fit.layers.density, 3)},
        {"frame", a.y_up ? "of the cameras; the model was turned from y up to z up"
                         : "of the cameras and the model"}};
    if (fit.background) // what renderers show around the mesh
        facts.emplace_back("background", text_of(fit.background));
    return metadata_of(facts);
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

// Draws the photographs' views from the file, and compares them with the photographs.
Result<std::vector<ComparedPhotograph>> measure(const FitCommand& a, const corpus::PhotoFit& fit,
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
        TESSERA_TRY_ASSIGN(const View view,
                           stage.subject().render(make_camera(photographs[i].camera)));
        TESSERA_TRY_ASSIGN(
            const corpus::PhotoPixels seen,
            read_photograph(photographs[i], fit.background.value_or(glm::dvec3(0.0))));
        compared.push_back(compare_pixels(seen, codes_of(view)));
        compared.back().name = names[i];
        if (show)
            show("measuring", static_cast<double>(i + 1), static_cast<double>(photographs.size()));
    }
    return compared;
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
Json pictures_json(const corpus::PhotoFit& fit, std::span<const PosedPhotograph> photographs) {
    Json pictures = Json::array();
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        const corpus::PhotoDifference& d = fit.differences[i];
        pictures.push_back({{"name", photographs[i].name},
                            {"error", d.error},
                            {"gain", d.gain},
                            {"shift", {d.shift.x, d.shift.y}},
                            {"left_out", std::ranges::count(fit.left_out, i) > 0}});
    }
    return pictures;
}

struct FitResult {
    corpus::PhotoFit fit;
    CodedLayers coded;
    std::vector<ComparedPhotograph> held_out;
    double seconds = 0;
};

void report(const FitCommand& a, const FitResult& r, std::span<const PosedPhotograph> fitted,
            const Warnings& warnings) {
    const std::size_t photographs = fitted.size() - r.fit.left_out.size();
    if (a.encode.json) {
        Json json = {{"output", a.output},
                     {"bytes", r.coded.file.size()},
                     {"mesh_bytes", r.fit.layers.mesh.size()},
                     {"quality", r.coded.quality},
                     {"seconds", r.seconds},
                     {"photographs", photographs},
                     {"pictures", pictures_json(r.fit, fitted)},
                     {"fitted_pixels", r.fit.pixels},
                     {"background", text_of(r.fit.background)},
                     {"smoothness", r.fit.smoothness},
                     {"texels_per_unit", r.fit.layers.density},
                     {"error", r.fit.error},
                     {"layers", layers_json(r.coded)},
                     {"warnings", warnings.json()}};
        if (!r.held_out.empty())
            json["held_out"] = figures_json(r.held_out);
        print_json(json);
        return;
    }
    warnings.print("fit");
    if (a.texture.quiet)
        return;
    std::printf("%s: %s in %.1f s, quality %s\n", a.output.c_str(),
                human_bytes(r.coded.file.size()).c_str(), r.seconds,
                format_number(r.coded.quality, 1).c_str());
    std::printf("  %zu photographs, %zu pixels that see the mesh; background %s; smoothness %s\n",
                photographs, r.fit.pixels, text_of(r.fit.background).c_str(),
                format_number(r.fit.smoothness, 3).c_str());
    std::printf("  the fit differs from its photographs by %s dB before it is coded\n",
                format_number(-20 * std::log10(std::max(r.fit.error, 1e-5)), 2).c_str());
    print_layers(stdout, r.fit.layers, r.coded);
    if (!r.held_out.empty())
        print_photographs("held out", figures_of(r.held_out), r.held_out);
}

Status add_warnings(const corpus::PhotoFit& fit, std::span<const PosedPhotograph> photographs,
                    Warnings& warnings) {
    for (const std::size_t i : fit.left_out)
        TESSERA_TRY(warnings.add("photographs that fit none of the others are left out",
                                 photographs[i].name));
    for (std::size_t i = 0; i < photographs.size(); ++i) {
        const glm::dvec2& shift = fit.differences[i].shift;
        if (std::max(std::abs(shift.x), std::abs(shift.y)) > 0.0)
            TESSERA_TRY(warnings.add("photographs are moved by a fraction of a pixel to where the "
                                     "others show the mesh",
                                     photographs[i].name));
    }
    return {};
}

Status run(const FitCommand& a) {
    TESSERA_TRY(check_fit(a));
    const auto start = std::chrono::steady_clock::now();
    Warnings warnings(a.encode.strict);
    TESSERA_TRY_ASSIGN(auto set, corpus::read_photographs(a.photographs, {.images = a.images}));
    for (const corpus::PhotographNote& note : set.notes)
        TESSERA_TRY(warnings.add(note.kind, note.place, note.count));
    const SplitPhotographs photographs = split(std::move(set.photographs), a.hold_out);
    TESSERA_TRY_ASSIGN(const corpus::Model model, load_mesh(a));
    TESSERA_TRY_ASSIGN(corpus::PhotoFitOptions options, fit_options(a));
    FitResult result;
    {
        Progress progress("tessera fit", a.texture.quiet || a.encode.json);
        options.run.progress = progress.function();
        TESSERA_TRY_ASSIGN(result.fit, corpus::fit_photographs(model, photographs.fitted, options)
                                           .with_context(a.photographs));
        TESSERA_TRY(add_warnings(result.fit, photographs.fitted, warnings));
        TESSERA_TRY_ASSIGN(
            EncodeOptions encode,
            make_encode_options(a.encode, a.texture.threads,
                                fit_metadata(a, result.fit, photographs.fitted.size()), {}));
        encode.mesh = result.fit.layers.mesh;
        encode.progress = options.run.progress;
        encode.cancelled = options.run.cancelled;
        TESSERA_TRY_ASSIGN(result.coded, encode_layers(result.fit.layers, encode, a.encode.quality,
                                                       a.encode.target_bytes)
                                             .with_context(a.output));
        TESSERA_TRY(make_parent_folders(a.output));
        TESSERA_TRY(write_bytes(a.output, result.coded.file));
        if (!photographs.held_out.empty()) {
            TESSERA_TRY_ASSIGN(result.held_out, measure(a, result.fit, photographs.held_out,
                                                        options.filter, options.run.progress));
        }
    }
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    report(a, result, photographs.fitted, warnings);
    return {};
}

Status run_fit(const FitCommand& a) {
    return with_memory_hint(run(a));
}

void declare(CLI::App& c, FitCommand& a) {
    add_rate_options(c, a.encode); // the first heading
    c.add_option("photographs", a.photographs,
                 "A transforms.json of NeRF or nerfstudio, a COLMAP model, or a folder with one")
        ->option_text("PHOTOS");
    c.add_option("-o,--output", a.output, "The .tess file");
    c.add_option("--mesh", a.mesh,
                 "The object's surface: .gltf, .glb, .obj or .ply, in the frame of the cameras")
        ->option_text("MODEL");
    c.add_flag("--y-up", a.y_up,
               "Turn a model with y up, as glTF has it, to cameras with z up, as Blender has them");
    c.add_option("--images", a.images, "Folder of the pictures. Default: where the cameras say")
        ->option_text("FOLDER");
    c.add_option("--hold-out", a.hold_out,
                 "Keep every Nth photograph out of the fit and compare it with the result")
        ->option_text("N")
        ->check(CLI::Range(2u, 100000u));
    add_run_options(c, a.encode);
    add_threads_options(c, a.texture);
    OptionGroup photos(c, "How the photographs were made");
    photos.option("--background", "R,G,B", a.background,
                  "Colour behind the object, 0..1, or white or black. Default: that of the "
                  "pictures' borders if it is the same everywhere; otherwise silhouettes do not "
                  "count");
    photos.option(
        "--pixel-filter", "NAME[:WIDTH]", a.pixel_filter,
        "What a pixel shows: box (default), gauss or blackman-harris, also with a width in "
        "pixels; pictures of Blender's Cycles need blackman-harris");
    photos.flag("--no-corrections", a.no_corrections,
                "Trust all photographs: do not estimate exposures, small shifts and outliers");
    OptionGroup fit(c, "What is fitted");
    fit.option("--texels", "N", a.texels, "Most texels of colour. Default: 1000000",
               number_between(1024, 67108864));
    fit.option("--density", "N", a.density,
               "Texels of colour per unit of the mesh. Default: as fine as the nearest pixels",
               number_between(1e-6, 1e9));
    fit.option("--cell", "N", a.cell,
               "Texels of colour along a side of a group that shares its directions. Default: 8",
               CLI::Range(1u, 64u));
    fit.option("--directions", "N", a.directions,
               "Directions of a group along s and t. Default: 16", CLI::Range(1u, 128u));
    fit.option("--shared-directions", "N", a.shared_directions,
               "Directions that the whole object shares, along s and t. Default: 64",
               CLI::Range(1u, 256u));
    fit.option("--smoothness", "X", a.smoothness,
               "How alike neighbours are kept: 0.25 for metal, 4 for matt boxes. Default: chosen "
               "by predicting photographs that trial fits have not seen",
               number_between(0.01, 100));
}

} // namespace

void add_fit_command(CLI::App& app, Invocation& chosen) {
    add_verb<FitCommand>(
        app, chosen, "fit", "Make a texture of a mesh from photographs with known cameras",
        "Finds the texture that explains all photographs best: each pixel is a weighted sum of "
        "texels, so it is a least-squares problem. The file has the object's colour, what changes "
        "with the direction for the whole object, and what changes for groups of its places. It "
        "is an ordinary file with layers: view, render, info and validate work.\n\n"
        "Photographs need the same light, an object that does not move, and a mesh in the "
        "cameras' units.\n\n"
        "Examples:\n"
        "  tessera fit transforms_train.json --mesh object.obj -o object.tess\n"
        "  tessera fit colmap/ --mesh scan.ply -o scan.tess --hold-out 8 --target-bytes 200k\n"
        "  tessera render scan.tess --cameras colmap/ -o views/\n"
        "  tessera compare colmap/ views/",
        declare, run_fit);
}

} // namespace tessera
