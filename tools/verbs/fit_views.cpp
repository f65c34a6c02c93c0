// Fits to a sphere and to planar views.
#include "corpus/fit/view_fit.h"
#include "tools/support/camera_grid.h"
#include "tools/support/encode_report.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/verbs/fit_arguments.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

using corpus::PosedPhotograph;

Result<corpus::ViewFitOptions> view_options(const FitCommand& a) {
    corpus::ViewFitOptions options;
    TESSERA_TRY(set_solve_options(a, options));
    options.most_texels = a.texels.value_or(options.most_texels);
    options.directions = a.directions.value_or(options.directions);
    if (a.surface == "sphere")
        options.focus = a.focus.value_or(0.0);
    return options;
}

std::string point_text(const glm::dvec3& p) {
    char text[100];
    std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g", p.x, p.y, p.z);
    return text;
}

// Where the texture lies, before it is fitted.
struct ViewSurface {
    std::optional<corpus::PhotoSphere> sphere; // otherwise a window
    corpus::SizedWindow window;
    Description description;
    Metadata metadata;
    std::string text; // one line for people
};

Result<ViewSurface> sphere_surface(const FitCommand& a,
                                   std::span<const PosedPhotograph> photographs,
                                   const corpus::ViewFitOptions& options) {
    corpus::SphereWish wish;
    if (!a.centre.empty()) {
        glm::dvec3 centre;
        TESSERA_TRY(parse_point(a.centre, centre).with_context("--centre"));
        wish.centre = centre;
    }
    wish.radius = a.radius;
    TESSERA_TRY_ASSIGN(const corpus::PhotoSphere sphere,
                       corpus::sphere_of(photographs, wish, options.background));
    ViewSurface surface;
    surface.sphere = sphere;
    Description& d = surface.description;
    d.proxy = Proxy::sphere;
    d.surface_map = SurfaceMap::sphere_longitude_latitude;
    d.angular_map = AngularMap::hemisphere_alpha_beta;
    for (glm::length_t i = 0; i < 3; ++i)
        d.sphere_centre[i] = static_cast<float>(sphere.centre[i]);
    d.sphere_radius = static_cast<float>(sphere.radius);
    surface.text = "sphere around " + point_text(sphere.centre) +
                   (wish.centre ? "" : " (estimated)") + " with the radius " +
                   format_number(sphere.radius, 6) + (wish.radius ? "" : " (estimated)");
    return surface;
}

Result<ViewSurface> window_surface(const FitCommand& a,
                                   std::span<const PosedPhotograph> photographs,
                                   const corpus::ViewFitOptions& options) {
    double focus = a.focus.value_or(0.0);
    if (!a.focus) {
        TESSERA_TRY_ASSIGN(focus, corpus::choose_focus(photographs, options));
    }
    ViewSurface surface;
    TESSERA_TRY_ASSIGN(surface.window, corpus::window_of(photographs, focus, options.directions,
                                                         options.most_texels));
    const corpus::PhotoWindow& window = surface.window.window;
    surface.description.angular_map = AngularMap::planar_views;
    surface.metadata[cameras_key] =
        to_string(CameraGrid{window.spacing_x, window.spacing_y, window.distance, window.width});
    surface.metadata[window_key] = to_string(WindowPlace{window.centre, window.axes});
    surface.text = "window at the distance " + format_number(focus, 6) +
                   (a.focus ? "" : " (estimated)") + " from " + std::to_string(window.cameras[0]) +
                   "x" + std::to_string(window.cameras[1]) + " cameras, its centre at " +
                   point_text(window.centre);
    return surface;
}

} // namespace

Status fit_views(const FitCommand& a, const SplitPhotographs& photographs, Warnings& warnings) {
    const auto start = std::chrono::steady_clock::now();
    const std::span<const PosedPhotograph> fitted = photographs.fitted;
    TESSERA_TRY_ASSIGN(corpus::ViewFitOptions options, view_options(a));
    if (!options.background) {
        TESSERA_TRY_ASSIGN(options.background, corpus::common_background(fitted));
    }
    const bool shows = !a.texture.quiet && !a.encode.json;
    ViewSurface surface;
    corpus::ViewFit fit;
    EncodeReport coded;
    EncodeOptions encode;
    std::vector<ComparedPhotograph> held_out;
    {
        Progress progress("tessera fit", !shows);
        options.run.progress = progress.function();
        TESSERA_TRY_ASSIGN(
            surface, (a.surface == "sphere" ? sphere_surface : window_surface)(a, fitted, options)
                         .with_context(a.photographs));
        TESSERA_TRY_ASSIGN(fit,
                           (surface.sphere ? corpus::fit_sphere(*surface.sphere, fitted, options)
                                           : corpus::fit_window(surface.window, fitted, options))
                               .with_context(a.photographs));
        if (surface.sphere)
            surface.text += ", focus at the radius " + format_number(fit.focus, 6) +
                            (a.focus ? "" : " (estimated)");
        TESSERA_TRY(add_fit_warnings(fit, fitted, warnings));
        Metadata metadata = fit_metadata(a, fit, fitted.size(), {{"surface", surface.text}});
        metadata.merge(surface.metadata);
        surface.description.transfer = Transfer::srgb;
        surface.description.primaries = Primaries::bt709;
        TESSERA_TRY_ASSIGN(encode, make_encode_options(a.encode, a.texture.threads,
                                                       std::move(metadata), surface.description));
        encode.journal = JournalUse::none;
        encode.progress = options.run.progress;
        encode.cancelled = options.run.cancelled;
        TESSERA_TRY(check_for(a.encode, encode, fit.desc));
        MemorySource texels(fit.desc, fit.texels), mask(fit.mask_desc, fit.mask);
        if (a.masks_unseen())
            encode.mask = &mask;
        TESSERA_TRY_ASSIGN(coded, encode_to(texels, a.output, encode));
        encode.mask = nullptr; // it ends here
        if (!photographs.held_out.empty()) {
            TESSERA_TRY_ASSIGN(held_out, measure_fit(a, fit, photographs.held_out, options.filter,
                                                     options.run.progress));
        }
    }
    coded.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (a.encode.json) {
        Json json = report_json(a.output, fit.desc, encode, coded);
        json["surface"] = surface.text;
        json["warnings"] = warnings.json();
        add_fit_findings(fit, fitted, held_out, json);
        print_json(json);
        return check_target(a.output, encode, coded);
    }
    warnings.print("fit");
    if (!a.texture.quiet) {
        print_report(stdout, a.output, fit.desc, coded);
        std::printf("  %s\n", surface.text.c_str());
        print_fit_findings(fit, fitted.size(), a.surface == "sphere" ? "sphere" : "window");
        if (!held_out.empty())
            print_photographs("held out", figures_of(held_out), held_out);
    }
    return check_target(a.output, encode, coded);
}

} // namespace tessera
