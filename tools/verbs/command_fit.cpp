#include "corpus/model/model.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/verbs/command.h"
#include "tools/verbs/fit_arguments.h"

namespace tessera {
namespace {

SplitPhotographs split(std::vector<corpus::PosedPhotograph> all, std::optional<unsigned> hold_out) {
    SplitPhotographs parts;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool out = hold_out && i % *hold_out == *hold_out - 1;
        (out ? parts.held_out : parts.fitted).push_back(std::move(all[i]));
    }
    return parts;
}

// Refuses options that do not belong to the surface.
Status check_surface(const FitCommand& a) {
    if (!a.mesh.empty() && !a.surface.empty())
        return {ErrorCode::bad_argument, "--mesh and --surface: only one surface is possible"};
    const bool mesh = !a.mesh.empty(), sphere = a.surface == "sphere";
    struct Belongs {
        const char* option;
        bool given, fits;
        const char* to;
    };
    for (const Belongs& b :
         {Belongs{"--density", a.density.has_value(), mesh, "--mesh"},
          Belongs{"--cell", a.cell.has_value(), mesh, "--mesh"},
          Belongs{"--shared-directions", a.shared_directions.has_value(), mesh, "--mesh"},
          Belongs{"--y-up", a.y_up, mesh, "--mesh"},
          Belongs{"--centre", !a.centre.empty(), sphere, "--surface sphere"},
          Belongs{"--radius", a.radius.has_value(), sphere, "--surface sphere"},
          Belongs{"--focus", a.focus.has_value(), !mesh, "--surface"}})
        if (b.given && !b.fits)
            return {ErrorCode::bad_argument, std::string(b.option) + ": belongs to " + b.to};
    constexpr unsigned most_directions = 64; // without a mesh
    if (!mesh && a.directions.value_or(0) > most_directions)
        return {ErrorCode::bad_argument, "--directions: without a mesh, there are at most " +
                                             std::to_string(most_directions)};
    return {};
}

Status check_fit(const FitCommand& a) {
    if (a.photographs.empty() || a.output.empty() || (a.mesh.empty() && a.surface.empty()))
        return {ErrorCode::bad_argument,
                "PHOTOS, -o OUTPUT.tess, and either --mesh MODEL or --surface are needed"};
    TESSERA_TRY(check_surface(a));
    if (!a.mesh.empty() && !corpus::is_model_path(a.mesh))
        return {ErrorCode::bad_argument,
                "--mesh " + a.mesh + ": not a .gltf, .glb, .obj, .ply or .stl model"};
    // Wrong rates shall not be found after minutes of work.
    TESSERA_TRY_ASSIGN(const EncodeOptions options,
                       make_encode_options(a.encode, a.texture.threads, {}, {}));
    if (a.encode.max_error) {
        constexpr Extent4 any{64, 64, 1, 1};
        TESSERA_TRY(check_for(a.encode, options, {any, SampleType::unorm8, 3}));
    }
    return check_tess_output(a.encode, a.output);
}

Status run(const FitCommand& a) {
    TESSERA_TRY(check_fit(a));
    Warnings warnings(a.encode.strict);
    TESSERA_TRY_ASSIGN(
        auto set, corpus::read_photographs(a.photographs, {.images = a.images, .masks = a.masks}));
    for (const corpus::PhotographNote& note : set.notes)
        TESSERA_TRY(warnings.add(note.kind, note.place, note.count));
    const SplitPhotographs photographs = split(std::move(set.photographs), a.hold_out);
    return (a.mesh.empty() ? fit_views : fit_mesh)(a, photographs, warnings);
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
    c.add_option(
         "--mesh", a.mesh,
         "The object's surface: .gltf, .glb, .obj, .ply or .stl, in the frame of the cameras")
        ->option_text("MODEL");
    c.add_option("--surface", a.surface,
                 "Without a mesh: a sphere around the object, or planar views through a window, "
                 "from cameras that look in about the same direction")
        ->option_text("sphere or planar")
        ->check(one_of({"sphere", "planar"}));
    c.add_flag("--y-up", a.y_up,
               "Turn a model with y up, as glTF has it, to cameras with z up, as Blender has them");
    c.add_option("--images", a.images, "Folder of the pictures. Default: where the cameras say")
        ->option_text("FOLDER");
    c.add_option("--masks", a.masks,
                 "Folder of COLMAP's masks, NAME.png for the picture NAME: what is black does not "
                 "count")
        ->option_text("FOLDER");
    c.add_option("--hold-out", a.hold_out,
                 "Keep every Nth photograph out of the fit and compare it with the result")
        ->option_text("N")
        ->check(CLI::Range(2u, 100000u));
    add_memory_option(c, a.encode.memory);
    c.add_flag("--json", a.encode.json, "Print the result as JSON");
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
    fit.option("--texels", "N", a.texels,
               "Most texels of colour; without a mesh, of the whole texture. Default: 1000000; "
               "without a mesh 4000000",
               number_between(1024, 67108864));
    fit.option("--density", "N", a.density,
               "Texels of colour per unit of the mesh. Default: as fine as the nearest pixels",
               number_between(1e-6, 1e9));
    fit.option("--cell", "N", a.cell,
               "Texels of colour along a side of a group that shares its directions. Default: 8",
               CLI::Range(1u, 64u));
    fit.option(
        "--directions", "N", a.directions,
        "Directions of a group along s and t. Default: 16. Without a mesh: of a place of the "
        "sphere, or cameras along the longer side of their plane; default: about as many "
        "as there are photographs for",
        CLI::Range(1u, 128u));
    fit.option("--centre", "X,Y,Z", a.centre,
               "Of the sphere. Default: the place nearest to the axes of all cameras");
    fit.option("--radius", "LENGTH", a.radius,
               "Of the sphere. Default: as large as half of the photographs show it whole, or "
               "smaller if the background shows that the object is",
               number_between(1e-9, 1e9));
    fit.option(
        "--focus", "LENGTH", a.focus,
        "Where the object's surface is on average: the distance of the window from the "
        "cameras, or the radius of a sphere inside the sphere. Default: chosen by predicting "
        "photographs that trial fits have not seen",
        number_between(1e-9, 1e6));
    fit.option("--unseen", "WORD", a.unseen,
               "Texels that no photograph shows: fill (default) continues what surrounds them, "
               "dont-care lets them take the values that cost least",
               one_of({"fill", "dont-care"}));
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
        app, chosen, "fit", "Make a texture from photographs with known cameras",
        "Finds the texture that explains all photographs best: each pixel is a weighted sum of "
        "texels, so it is a least-squares problem. With a mesh, the file has layers: the object's "
        "colour, what changes with the direction for the whole object, and what changes for "
        "groups of its places. Without one, it has a texture on a sphere or planar views, which "
        "need many more photographs. All are ordinary files: view, render, info and validate "
        "work.\n\n"
        "Photographs need the same light, an object that does not move, and a mesh in the "
        "cameras' units.\n\n"
        "Examples:\n"
        "  tessera fit transforms_train.json --mesh object.obj -o object.tess\n"
        "  tessera fit colmap/ --mesh scan.ply -o scan.tess --hold-out 8 --target-bytes 200k\n"
        "  tessera fit transforms.json --surface sphere -o ball.tess --target-psnr 40\n"
        "  tessera fit rig/transforms.json --surface planar -o rig.tess\n"
        "  tessera render scan.tess --cameras colmap/ -o views/\n"
        "  tessera compare colmap/ views/",
        declare, run_fit);
}

} // namespace tessera
