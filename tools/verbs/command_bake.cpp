#include "corpus/bake.h"
#include "corpus/catalog.h"
#include "tools/scenes/baked_surface.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/copy_texture.h"
#include "tools/support/description_text.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/bake_choice.h"
#include "tools/verbs/bake_layers.h"
#include "tools/verbs/bake_scene.h"
#include "tools/verbs/bake_sources.h"
#include "tools/verbs/command.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

Status list_scenes() {
    for (const corpus::SceneInfo& scene : corpus::scenes())
        std::printf("%-14s %-16s %-7s %s\n", scene.name.c_str(),
                    to_string(scene.default_size).c_str(), name_of(scene.type),
                    scene.description.c_str());
    return {};
}

// Refuses options that an uncompressed output would silently ignore.
Status check_plain_output(const BakeCommand& a) {
    if (const std::string option = option_of_encoder(a.encode); !option.empty())
        return {ErrorCode::bad_argument, option + ": needs a .tess output, not " + a.output};
    if (kind_of(a.output) != TextureKind::raw)
        return {};
    for (const auto& [field, text] : a.encode.description)
        if (field != "proxy" || (text != "sphere" && text != "mesh")) // these choose what to bake
            return {ErrorCode::bad_argument,
                    "--" + field + ": needs a .tess, .exr or folder/ output; a raw file, " +
                        a.output + ", holds samples only"};
    return {};
}

// The options of the encoder. Finds all errors that can be found before a texel is baked.
Result<EncodeOptions> options_for(const BakeCommand& a, const Baking& baking) {
    const TextureDesc& desc = baking.texels->desc();
    const bool compressed = is_compressed(a);
    TESSERA_TRY_ASSIGN(auto options,
                       make_encode_options(a.encode, a.texture.threads, metadata_of(baking.facts),
                                           baking.description));
    options.mesh = baking.mesh;
    options.mask = baking.mask.get();
    if (a.encode.tile.empty())
        options.tile_extent = baking.tile;
    TESSERA_TRY(check_for(a.encode, options, desc));
    TESSERA_TRY(compressed ? check_compressed_output(a) : check_texture_output(a.output, desc));
    options.labels.facts = baking.facts;
    options.labels.facts.insert(options.labels.facts.end(), baking.input_facts.begin(),
                                baking.input_facts.end());
    return options;
}

Status bake_compressed(const BakeCommand& a, const Baking& baking, EncodeOptions options) {
    TexelSource& source = *baking.texels;
    const bool to_glb = is_glb_name(a.output);
    std::vector<std::byte> tess; // of a .glb
    TESSERA_TRY_ASSIGN(const auto report, [&] {
        Progress progress("tessera bake", a.texture.quiet);
        options.progress = progress.function();
        return to_glb ? encode_memory(source, tess, options) : encode_to(source, a.output, options);
    }());
    std::optional<GlbReport> glb;
    if (to_glb) {
        TESSERA_TRY_ASSIGN(glb, write_baked_glb(a, tess));
    }
    count_replaced(report, *baking.warnings);
    if (a.encode.json) {
        Json json = report_json(a.output, source.desc(), options, report);
        json.update(baking.json);
        json["warnings"] = baking.warnings->json();
        if (glb)
            json["glb"] = to_json(*glb);
        print_json(json);
    } else if (!a.texture.quiet) {
        print_report(summary_stream(a.output), a.output, source.desc(), report);
        if (!baking.remark.empty())
            std::fprintf(summary_stream(a.output), "  %s\n", baking.remark.c_str());
        if (glb)
            std::printf("  glTF file of %s\n", to_string(*glb).c_str());
    }
    baking.warnings->print("bake");
    return check_target(a.output, options, report);
}

Status bake_plain(const BakeCommand& a, const Baking& baking, const EncodeOptions& options) {
    TexelSource& source = *baking.texels;
    const auto start = std::chrono::steady_clock::now();
    const TextureDesc& desc = source.desc();
    TESSERA_TRY_ASSIGN(auto sink,
                       create_texture(a.output, desc, options.description, a.texture.threads));
    {
        Progress progress("tessera bake", a.texture.quiet);
        TESSERA_TRY(copy_texture(source, *interruptible(std::move(sink)), a.texture.threads,
                                 progress.function(), "baking", options.slab_bytes));
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const std::uint64_t bytes = desc.box_bytes(Box4::whole(desc.size));
    if (a.encode.json) {
        Json json = {{"output", a.output},         {"size", to_string(desc.size)},
                     {"type", name_of(desc.type)}, {"channels", desc.channels},
                     {"raw_bytes", bytes},         {"seconds", seconds.count()}};
        json.update(baking.json);
        print_json(json);
    } else if (!a.texture.quiet) {
        std::printf("%s: %s, %d x %s, %s of texels in %.2f s\n", a.output.c_str(),
                    to_string(desc.size).c_str(), desc.channels, name_of(desc.type),
                    human_bytes(bytes).c_str(), seconds.count());
    }
    return {};
}

// Refuses options that only layers can honour.
Status check_no_layer_options(const BakeCommand& a, const std::string& why) {
    const std::string option = a.layered ? "--layered" : option_of_model_layers(a);
    return option.empty() ? Status() : Status(ErrorCode::bad_argument, option + ": " + why);
}

Status bake_texture(BakeCommand a, ModelToBake* model) {
    TESSERA_TRY_ASSIGN(Baking baking, make_baking(a, model));
    if (!baking.warnings)
        baking.warnings = std::make_unique<Warnings>(a.encode.strict);
    baking.texels = interruptible(std::move(baking.texels)); // reading bakes
    TESSERA_TRY_ASSIGN(const auto options, options_for(a, baking));
    return is_compressed(a) ? bake_compressed(a, baking, options) : bake_plain(a, baking, options);
}

Status bake_model(const BakeCommand& a) {
    TESSERA_TRY(check_model(a));
    TESSERA_TRY(surface_wish(a).status());
    if (a.layered)
        TESSERA_TRY(check_layered(a));
    if (a.single)
        TESSERA_TRY(check_no_layer_options(a, "does not apply to --single"));
    TESSERA_TRY_ASSIGN(ModelToBake model, load_model_to_bake(a));
    TESSERA_TRY_ASSIGN(const BakeChoice choice, choose_layers(a, model));
    say_choice(a, choice);
    if (choice.layered)
        return bake_layered(a, std::move(model));
    TESSERA_TRY(check_no_layer_options(a, "needs layers, but " + choice.why));
    return bake_texture(a, &model);
}

Status bake_scene(const BakeCommand& a) {
    if (const std::string option = option_of_model_layers(a); !option.empty())
        return {ErrorCode::bad_argument,
                option + ": needs a model, not the built-in scene " + a.scene};
    TESSERA_TRY(check_scene(a.scene));
    if (!is_on_own_surfaces(a)) {
        if (a.layered || a.single)
            return {ErrorCode::bad_argument, std::string(a.layered ? "--layered" : "--single") +
                                                 ": a built-in scene needs --proxy mesh, too"};
        return bake_texture(a, nullptr);
    }
    TESSERA_TRY(check_mesh_options(a));
    TESSERA_TRY(check_no_model_options(a.model));
    if (a.single)
        TESSERA_TRY(check_no_layer_options(a, "does not apply to --single"));
    if (const auto map = a.encode.description.find("angular-map");
        map != a.encode.description.end())
        TESSERA_TRY(parse_octahedral_map(map->second).status().with_context("--angular-map"));
    TESSERA_TRY_ASSIGN(const BakeChoice choice, choose_scene_layers(a));
    say_choice(a, choice);
    return choice.layered ? bake_layered_scene(a) : bake_texture(a, nullptr);
}

Status run(const BakeCommand& a) {
    if (a.list)
        return list_scenes();
    if (a.scene.empty() || a.output.empty())
        return {ErrorCode::bad_argument,
                "a scene and -o OUTPUT are needed; --list shows the scenes"};
    TESSERA_TRY(check_has_glb_mesh(a));
    if (!is_compressed(a))
        TESSERA_TRY(check_plain_output(a));
    else
        TESSERA_TRY(check_compressed_output(a)); // before a model is loaded
    if (corpus::is_model_path(a.scene))
        return with_memory_hint(bake_model(a));
    return with_memory_hint(bake_scene(a));
}

// Options of encode that work here, too. The help of encode explains them.
void hide_from_help(CLI::App& c) {
    for (CLI::Option* option : c.get_options())
        if (option->get_group() == layout_heading || option->get_group() == description_heading)
            option->group("");
}

constexpr const char* mesh_heading = "On a mesh (--proxy mesh, and models)";

void declare(CLI::App& c, BakeCommand& a) {
    add_rate_options(c, a.encode); // the first heading
    c.add_option("scene", a.scene,
                 "Name of a built-in scene, or a model: .gltf, .glb, .obj, .ply, .stl");
    c.add_option("-o,--output", a.output,
                 ".tess (- is one on standard output), .glb, .exr, raw samples (.rgb), folder/");
    c.add_flag("--list", a.list, "List the built-in scenes and stop");
    add_run_options(c, a.encode);
    add_threads_options(c, a.texture);
    c.add_option("--spp", a.samples, "Rays per texel, over all four dimensions. Default: 16")
        ->check(CLI::Range(1u, corpus::max_samples_per_texel))
        ->option_text("N");
    OptionGroup sphere(c, "On a sphere"), mesh(c, mesh_heading);
    add_layout_options(c, a.encode);
    add_description_options(c, a.encode);
    hide_from_help(c);
    c.get_option("--proxy")
        ->description("What the texture lies on. sphere: the one around the scene (default); mesh: "
                      "the scene's own surfaces; sphere-inside:cx,cy,cz,r: a sphere in the scene "
                      "around the observer")
        ->group("Options");
    sphere.option("--size", "UxVxSxT", a.texture.size, "Size of the texture. Default: see --list");
    sphere.option("--seed", "N", a.seed, "Seed of the sample pattern. Default: 1");
    mesh.option("--density", "N", a.density,
                "Texels per world unit, fewer on mirrors and at a distance. Default: 64 for "
                "patterned objects, else 32 in layers and 16 in one texture; models, in their own "
                "units: such that there are 60,000",
                number_between(1e-6, 1e9));
    mesh.option("--directions", "SxT", a.directions,
                "Size of each angular image. Default: 24x24, or in one texture 16x16 if only some "
                "objects are glossy, 1x1 if none is");
    c.get_option("--angular-map")
        ->description("octahedral-hemisphere, octahedral-mirrored, or auto: the cheaper of both "
                      "(default)")
        ->group(mesh_heading);
    add_model_options(c, a.model);
    OptionGroup layers(c, "Layers");
    layers.flag("--layered", a.layered,
                "Bake colours, gloss, bumps, shadows and reflections into layers of their own, "
                "which are sharp close by in few bytes. Default: for models a trial with a few "
                "paths decides, for scenes on a mesh whether something shines");
    layers.flag("--single", a.single, "Bake one texture of all light instead");
    layers.option("--texels", "N", a.texels,
                  "Texels of a model's layer of colours. Default: three for each one that its "
                  "pictures have on its surface, but 1000000 to 2000000, or 4000000 if they have "
                  "at least as many",
                  number_between(1024, 67108864));
    layers.option("--lights", "N", a.lights,
                  "Lights that stand for the environment; 0: none, reflections hold all light. "
                  "Default: 16, or 32 if its light comes from broad parts of it, as a sky's does",
                  CLI::Range(0u, 1000u));
    layers.option("--noise", "DB", a.noise,
                  "PSNR that the noise of diffuse light has; up to 16 times the paths of --spp are "
                  "traced where it is less. Places that are seen from few directions may have up "
                  "to 6 dB less. Default: 45",
                  number_between(10, 80));
    add_glb_options(c, a.glb);
}

} // namespace

void add_bake_command(CLI::App& app, Invocation& chosen) {
    add_verb<BakeCommand>(
        app, chosen, "bake", "Ray trace a built-in scene or a model into a texture",
        "A .tess is compressed while it is baked, so the texture may be larger than the memory. "
        "For a .tess, the options of encode for the layout of the file and for the description "
        "work here, too. Other outputs are not compressed: .exr and folder/ accept the "
        "description, raw files only --size, --spp, --seed, --threads, --memory and --json.\n\n"
        "A texture on a sphere blurs what lies behind the surface of the sphere, whatever its "
        "size. --proxy mesh puts the texture on the surfaces themselves: the scene becomes a mesh "
        "whose charts share an atlas, and the file holds both. Texels that no surface uses cost "
        "almost nothing. Fine patterns need --density, sharp reflections need --directions.\n\n"
        "Examples:\n"
        "  tessera bake composed -o composed.tess --size 512x256x32x32 --spp 16\n"
        "  tessera bake composed -o composed.tess --resume    (after an interruption)\n"
        "  tessera bake composed -o mesh.tess --proxy mesh --target-bytes 16000\n"
        "  tessera bake mirror -o mirror.tess --proxy mesh --density 64 --directions 32x32\n"
        "  tessera bake bunny.glb -o bunny.tess --env studio.exr --spp 64\n"
        "  tessera bake helmet.glb -o helmet.tess --env studio.exr --texels 2000000\n"
        "  tessera bake bunny.glb -o one.tess --single --directions 24x24\n"
        "  tessera bake bunny.glb -o baked.glb --jpeg 85\n"
        "  tessera bake lamps -o lamps.exr --size 64x32x8x8",
        declare, run);
}

} // namespace tessera
