#include "tools/verbs/bake_layers.h"

#include "corpus/layers/clear_walls.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"
#include "tools/verbs/bake_choice.h"
#include "tools/verbs/encode_layers.h"

#include <chrono>
#include <cstdio>

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
    options.lights = a.lights.value_or(options.lights);
    options.samples = a.samples * paths_per_reflection;
    options.light.diffuse_samples = a.samples * paths_per_place;
    options.light.emitter_samples = a.samples * emitter_rays_per_place;
    options.light.shadow_samples = a.samples * rays_per_place;
    options.light.noise = a.noise.value_or(options.light.noise);
    options.light.seed = a.seed.value_or(usual_bake_seed);
    options.run.threads = a.texture.threads;
    options.run.cancelled = [] { return interrupted_by() != 0; };
    return options;
}

void report(const BakeCommand& a, const corpus::Model& model, const corpus::ModelLayers& baked,
            const CodedLayers& coded, const std::optional<GlbReport>& glb, const Warnings& warnings,
            double seconds) {
    if (a.encode.json) {
        Json json = {{"output", a.output},
                     {"bytes", coded.file.size()},
                     {"quality", *coded.quality},
                     {"seconds", seconds},
                     {"triangles", baked.decoded_mesh.triangles.size()},
                     {"charts", baked.charts},
                     {"mesh_bytes", baked.mesh.size()},
                     {"texels_per_unit", baked.density * model.frame.scale},
                     {"lights", baked.lights.size()},
                     {"noise_db", baked.noise},
                     {"warnings", warnings.json()},
                     {"layers", layers_json(coded)}};
        if (glb)
            json["glb"] = to_json(*glb);
        print_json(json);
        return;
    }
    warnings.print("bake");
    if (a.texture.quiet)
        return;
    std::FILE* const to = summary_stream(a.output);
    std::fprintf(to, "%s: %s in %.1f s, %s\n", a.output.c_str(),
                 human_bytes(coded.file.size()).c_str(), seconds, rate_text(coded).c_str());
    print_layers(to, baked, coded);
    std::fprintf(to, "  %zu lights, %s texels per unit, noise of diffuse light %s dB\n",
                 baked.lights.size(), format_digits(baked.density * model.frame.scale, 4).c_str(),
                 format_number(baked.noise, 1).c_str());
    if (glb)
        std::fprintf(to, "  glTF file of %s\n", to_string(*glb).c_str());
}

Status write_file(const std::string& path, std::span<const std::byte> bytes) {
    if (path == standard_stream) {
        TESSERA_TRY(write_standard_output(bytes));
        return flush_standard_output();
    }
    TESSERA_TRY(make_parent_folders(path));
    return write_bytes(path, bytes);
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
    const auto start = std::chrono::steady_clock::now();
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
    corpus::ModelLayers baked;
    CodedLayers coded;
    {
        Progress progress("tessera bake", a.texture.quiet || a.encode.json);
        options.run.progress = progress.function();
        TESSERA_TRY_ASSIGN(
            baked,
            corpus::bake_model_layers(file.model, file.light, options).with_context(a.scene));
        TESSERA_TRY_ASSIGN(
            EncodeOptions encode,
            make_encode_options(a.encode, a.texture.threads,
                                metadata_of(model_facts(
                                    a, file, baked.density * file.model.frame.scale, model.notes)),
                                {}));
        encode.mesh = baked.mesh;
        encode.progress = options.run.progress;
        encode.cancelled = options.run.cancelled;
        TESSERA_TRY_ASSIGN(
            coded, encode_layers(baked, encode, rate_of_layers(a.encode)).with_context(a.output));
    }
    std::optional<GlbReport> glb;
    if (is_glb_name(a.output)) {
        TESSERA_TRY_ASSIGN(glb, write_baked_glb(a, coded.file));
    } else {
        TESSERA_TRY(write_file(a.output, coded.file));
    }
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    report(a, file.model, baked, coded, glb, warnings, seconds.count());
    return {};
}

} // namespace tessera
