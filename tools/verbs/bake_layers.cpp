#include "tools/verbs/bake_layers.h"

#include "corpus/layers/clear_walls.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/verbs/bake_choice.h"
#include "tools/verbs/write_layers.h"

namespace tessera {
namespace {

// Paths and rays for each of --spp.
constexpr unsigned paths_per_place = 2, emitter_rays_per_place = 4, rays_per_place = 16,
                   paths_per_reflection = 4;

corpus::ModelLayersOptions layer_options(const BakeCommand& a, const corpus::SurfaceWish& wish,
                                         const LitModelFile& file) {
    corpus::ModelLayersOptions options;
    options.exposure = file.display.exposure;
    options.density = wish.density.value_or(0.0) / file.model.frame.scale;
    options.directions = wish.directions;
    options.texels = a.texels;
    options.lights = a.lights;
    options.samples = a.samples * paths_per_reflection;
    options.light.diffuse_samples = a.samples * paths_per_place;
    options.light.emitter_samples = a.samples * emitter_rays_per_place;
    options.light.shadow_samples = a.samples * rays_per_place;
    options.light.noise = a.noise.value_or(options.light.noise);
    options.light.seed = a.seed.value_or(usual_bake_seed);
    return options;
}

// Names what layers only approximate, once for each material that a triangle has.
Status warn_of_coats(const corpus::Model& model, const std::string& path, Warnings& warnings) {
    std::vector<bool> is_used(model.materials.size(), false);
    for (const corpus::ModelTriangle& triangle : model.triangles)
        is_used[triangle.material] = true;
    for (std::size_t i = 0; i < model.materials.size(); ++i) {
        const auto& coats = model.materials[i].coats;
        if (!is_used[i] || !coats)
            continue;
        const bool has_sheen = coats->sheen != glm::dvec3(0.0);
        for (const auto& [has, what] :
             {std::pair(coats->clear > 0.0,
                        "a clear coat and the mirror below it share a highlight"),
              std::pair(has_sheen, "sheen is blurred"),
              std::pair(coats->anisotropy > 0.0,
                        "highlights that are longer in one direction are blurred"),
              std::pair(coats->film > 0.0, "colours of iridescence are blurred"),
              std::pair(coats->through > 0.0, "transmitted light is blurred")})
            if (has)
                TESSERA_TRY(warnings.add(std::string("in layers ") + what, path));
    }
    return {};
}

} // namespace

Status check_layered(const BakeCommand& a) {
    const std::string option = option_of_one_texture(a);
    if (option.empty())
        return {};
    if (option.starts_with("--target") || option == "--max-error" || option == "--lossless")
        return {ErrorCode::bad_argument,
                option + ": does not apply to --layered; use --quality or --target-bytes"};
    return {ErrorCode::bad_argument, option + ": does not apply to --layered"};
}

Status bake_layered(const BakeCommand& a, ModelToBake model) {
    BakedLayers baked;
    TESSERA_TRY_ASSIGN(const corpus::SurfaceWish wish, surface_wish(a));
    corpus::make_clear_walls_blend(model.file.model);
    const LitModelFile& file = model.file;
    Warnings& warnings = *model.warnings;
    for (const corpus::ModelLamp& lamp : file.light.lamps)
        if (lamp.kind != corpus::ModelLamp::Kind::directional)
            TESSERA_TRY(warnings.add("highlights of lamps that are not directional are missing "
                                     "from layers",
                                     a.scene));
    TESSERA_TRY(warn_of_coats(file.model, a.scene, warnings));
    corpus::ModelLayersOptions options = layer_options(a, wish, file);
    {
        Progress progress("tessera bake", a.texture.quiet || a.encode.json);
        options.run = bake_run(a, progress.function());
        TESSERA_TRY_ASSIGN(
            baked.layers,
            corpus::bake_model_layers(file.model, file.light, options).with_context(a.scene));
    }
    baked.density = baked.layers.density * file.model.frame.scale;
    baked.facts = model_facts(a, file, baked.density, model.notes);
    baked.json = {{"noise_db", baked.layers.noise}};
    baked.remark = std::to_string(baked.layers.lights.size()) + " lights, " +
                   format_digits(baked.density, 4) + " texels per unit, noise of diffuse light " +
                   format_number(baked.layers.noise, 1) + " dB";
    return write_layers(a, baked, warnings);
}

} // namespace tessera
