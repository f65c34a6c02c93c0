#include "tools/verbs/bake_sources.h"

#include "corpus/model_surface/model_source.h"
#include "tools/scenes/baked_surface.h"
#include "tools/scenes/lit_model_file.h"
#include "tools/support/option_checks.h"
#include "tools/support/parse.h"
#include "tools/support/source_facts.h"
#include "tools/view/model_cameras.h"

#include <algorithm>
#include <cstdio>
#include <thread>

namespace tessera {
namespace {

// Diffuse light is computed once per surface point, with this many times the paths of a texel.
constexpr unsigned diffuse_share = 16;
constexpr unsigned noise_trials = 200;
constexpr Extent4 usual_tile{32, 32, 8, 8};

struct ModelFigures {
    std::size_t triangles = 0, charts = 0;
    double density = 0; // texels per world unit
    corpus::NoiseEstimate noise;
    std::vector<std::string> notes; // what the file has that is not baked
};

void add_facts(const BakeCommand& a, const LitModelFile& file, const ModelFigures& f,
               Baking& baking) {
    const char* const map = name_of(baking.description.angular_map);
    const double exposure = file.display.exposure;
    baking.facts = model_facts(a, file, f.density, f.notes);
    baking.input_facts = source_facts(a.scene, "model");
    for (auto& fact : source_facts(a.model.environment, "surroundings"))
        baking.input_facts.push_back(std::move(fact));
    baking.json = {{"model", a.scene},
                   {"samples_per_texel", a.samples},
                   {"texels_per_unit", f.density},
                   {"angular_map", map},
                   {"triangles", f.triangles},
                   {"charts", f.charts},
                   {"mesh_bytes", baking.mesh.size()},
                   {"exposure", exposure},
                   {"noise_db", f.noise.decibels},
                   {"notes", f.notes}};
    baking.remark = std::to_string(f.triangles) + " triangles in " +
                    human_bytes(baking.mesh.size()) + ", " + std::to_string(f.charts) +
                    " charts, " + format_digits(f.density, 4) + " texels per unit, " + map +
                    "; exposure " + format_number(exposure, 4) + "; sampling noise " +
                    format_number(f.noise.decibels, 1) +
                    " dB, --spp for 50 dB: " + format_number(f.noise.samples_for(50.0), 0);
}

} // namespace

Status check_model(const BakeCommand& a) {
    if (!a.texture.size.empty())
        return {ErrorCode::bad_argument,
                "--size: the size of a model comes from --density and --directions"};
    if (a.encode.description.contains("surface-map"))
        return {ErrorCode::bad_argument, "--surface-map: a mesh always has mesh-uv"};
    if (!is_compressed(a))
        return {ErrorCode::bad_argument,
                a.output + ": a model needs a .tess or .glb output, which holds the mesh"};
    return {};
}

Result<ModelToBake> load_model_to_bake(const BakeCommand& a) {
    ModelToBake model;
    TESSERA_TRY_ASSIGN(model.file, load_lit_model(a.scene, a.model));
    model.warnings = std::make_unique<Warnings>(a.encode.strict);
    if (const std::string note = placement_note(model.file.placement); !note.empty())
        model.file.model.notes.push_back(note);
    corpus::ModelFrame& frame = model.file.model.frame;
    frame = frame_of_mesh(frame, model.file.placement);
    for (corpus::ModelCamera& camera : model.file.cameras)
        camera.eye = frame.to_file(camera.eye);
    for (const std::string& note : model.file.model.notes) {
        model.notes.push_back(printable(note));
        TESSERA_TRY(model.warnings->add(model.notes.back(), a.scene));
    }
    TESSERA_TRY_ASSIGN(model.file.model,
                       corpus::with_both_sides(std::move(model.file.model)).with_context(a.scene));
    return model;
}

std::vector<std::pair<std::string, std::string>>
model_facts(const BakeCommand& a, const LitModelFile& file, double density,
            const std::vector<std::string>& notes) {
    std::vector<std::pair<std::string, std::string>> facts = {
        {"model", a.scene},
        {"samples per texel", std::to_string(a.samples)},
        {"seed", std::to_string(a.seed.value_or(usual_bake_seed))},
        {"texels per unit", format_digits(density, 6)}};
    std::string all;
    for (const std::string& note : notes)
        all += (all.empty() ? "" : "; ") + note;
    if (!all.empty())
        facts.emplace_back("notes", all);
    for (auto& fact : facts_of(file.placement))
        facts.push_back(std::move(fact));
    if (!file.cameras.empty())
        facts.emplace_back("model cameras", cameras_text(file.cameras));
    for (auto& fact : facts_of(a.model, file))
        facts.push_back(std::move(fact));
    return facts;
}

void add_model_options(CLI::App& app, ModelArguments& a) {
    OptionGroup group(app, "Models");
    group.option("--env", "FILE", a.environment,
                 "Environment light, .exr or .hdr by longitude and latitude. Default: a studio");
    group.option("--layer", "NAME", a.environment_layer,
                 "Layer of the environment, of an EXR that has several");
    group.option("--light", "X,Y,Z", a.light, "Direction towards a sun besides the environment");
    group.option("--exposure", "N", a.exposure,
                 "Factor from light to display. Default: mean white becomes 0.6",
                 number_between(1e-6, 1e6));
    group.option("--roughness", "0..1", a.roughness, "Of all materials, instead of their own",
                 number_between(0, 1));
    group.option("--metal", "0..1", a.metal, "Of all materials, instead of their own",
                 number_between(0, 1));
}

Status check_no_model_options(const ModelArguments& a) {
    for (const auto& [option, given] :
         {std::pair("--env", !a.environment.empty()),
          std::pair("--layer", !a.environment_layer.empty()),
          std::pair("--light", !a.light.empty()), std::pair("--exposure", a.exposure.has_value()),
          std::pair("--roughness", a.roughness.has_value()),
          std::pair("--metal", a.metal.has_value())})
        if (given)
            return {ErrorCode::bad_argument,
                    std::string(option) + ": needs a model; a built-in scene has its own"};
    return {};
}

Result<Baking> model_baking(const BakeCommand& a, ModelToBake model, const std::string& map) {
    TESSERA_TRY_ASSIGN(const corpus::SurfaceWish wish, surface_wish(a));
    TESSERA_TRY_ASSIGN(
        const auto wished_map,
        parse_octahedral_map(map.empty() ? "auto" : map).with_context("--angular-map"));
    const LitModelFile& file = model.file;
    Baking baking;
    baking.warnings = std::move(model.warnings);
    const Extent4 tile = wish.tile.value_or(usual_tile);
    const corpus::Texels2 directions = wish.directions.value_or(usual_directions);
    corpus::ModelAtlasOptions options;
    options.density = wish.density.value_or(0.0) / file.model.frame.scale;
    options.tile = {tile[axis_u], tile[axis_v]};
    TESSERA_TRY_ASSIGN(corpus::ModelAtlas atlas,
                       corpus::make_model_atlas(file.model, options).with_context(a.scene));
    baking.mesh = atlas.stream;
    ModelFigures figures{.triangles = atlas.mesh.triangles.size(),
                         .charts = atlas.charts.size(),
                         .density = atlas.density * file.model.frame.scale,
                         .noise = {},
                         .notes = std::move(model.notes)};
    corpus::LitModelOptions paths;
    paths.samples = a.samples;
    paths.diffuse_samples = std::min(65536u, a.samples * diffuse_share);
    paths.seed = a.seed.value_or(usual_bake_seed);
    paths.threads = a.texture.threads != 0 ? a.texture.threads
                                           : std::max(1u, std::thread::hardware_concurrency());
    TESSERA_TRY_ASSIGN(const auto lit, corpus::LitModel::make(std::move(atlas), file.light, paths));
    const AngularMap chosen =
        wished_map ? *wished_map : corpus::choose_angular_map(*lit, file.display, directions);
    TESSERA_TRY_ASSIGN(baking.texels,
                       corpus::make_model_source(lit, chosen, directions, file.display));
    baking.mask = corpus::make_model_mask(lit, chosen, directions);
    figures.noise =
        corpus::estimate_noise(*lit, chosen, directions, file.display, a.samples, noise_trials);
    baking.description.proxy = Proxy::mesh;
    baking.description.surface_map = SurfaceMap::mesh_uv;
    baking.description.angular_map = chosen;
    baking.description.transfer = Transfer::srgb;
    baking.description.primaries = Primaries::bt709;
    baking.tile = tile;
    add_facts(a, file, figures, baking);
    return baking;
}

} // namespace tessera
