#include "tools/verbs/bake_layers.h"

#include "corpus/layers/model_layers.h"
#include "tools/support/encode_report.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/progress.h"
#include "tools/support/standard_streams.h"

#include <chrono>
#include <cstdio>

namespace tessera {
namespace {

constexpr double usual_layer_quality = 50;
// Paths for each of --spp.
constexpr unsigned paths_per_place = 8, paths_per_reflection = 4;

Status check_layered(const BakeCommand& a) {
    const EncodeArguments& e = a.encode;
    for (const auto& [option, given] :
         {std::pair("--target-psnr", e.target_psnr.has_value()),
          std::pair("--target-bpt", e.target_bpt.has_value()),
          std::pair("--target-bytes", e.target_bytes.has_value()),
          std::pair("--max-error", e.max_error.has_value()), std::pair("--lossless", e.lossless),
          std::pair("--layers", e.layers), std::pair("--resume", e.resume),
          std::pair("--tile", !e.tile.empty())})
        if (given)
            return {ErrorCode::bad_argument,
                    std::string(option) + ": does not apply to --layered; --quality does"};
    return {};
}

// How much finer or coarser than the whole a layer is quantised. Errors of normals bend
// reflections, and those of visibility are multiplied by bright lights.
double quality_of(LayerRole role, double quality) {
    const double change = role == LayerRole::normal       ? 6
                          : role == LayerRole::visibility ? -14
                          : role == LayerRole::roughness  ? -4
                                                          : 0;
    return std::clamp(quality + change, 1.0, 100.0);
}

struct CodedLayer {
    const corpus::LayerTexture* texture = nullptr;
    std::vector<std::byte> bytes;
    double psnr = 0;
};

Result<CodedLayer> encode_layer(const BakeCommand& a, const corpus::LayerTexture& texture,
                                EncodeOptions options) {
    options.rate = {RateTarget::Kind::quality,
                    quality_of(texture.role, a.encode.quality.value_or(usual_layer_quality))};
    MemorySource source(texture.desc, texture.texels), mask(texture.mask_desc, texture.mask);
    options.mask = &mask;
    options.tile_extent = texture.tile;
    options.description.transfer = texture.transfer;
    options.description.surface_map = SurfaceMap::mesh_uv;
    options.description.angular_map =
        texture.role == LayerRole::visibility ? AngularMap::none : AngularMap::octahedral_mirrored;
    if (texture.role == LayerRole::diffuse)
        options.description.proxy = Proxy::mesh;
    else {
        options.mesh.clear();
        options.metadata.clear();
    }
    CodedLayer coded{&texture, {}, 0};
    TESSERA_TRY_ASSIGN(const EncodeReport report, encode_memory(source, coded.bytes, options));
    coded.psnr = report.psnr;
    return coded;
}

Result<std::vector<std::byte>> join(const corpus::ModelLayers& baked,
                                    const std::vector<CodedLayer>& coded) {
    std::vector<LayerFile> further;
    for (std::size_t i = 1; i < coded.size(); ++i)
        further.push_back(
            {coded[i].texture->role, static_cast<float>(coded[i].texture->scale), coded[i].bytes});
    return join_layers(coded[0].bytes, static_cast<float>(coded[0].texture->scale), further,
                       baked.lights);
}

corpus::ModelLayersOptions layer_options(const BakeCommand& a, const corpus::SurfaceWish& wish,
                                         double exposure) {
    corpus::ModelLayersOptions options;
    options.exposure = exposure;
    options.density = wish.density.value_or(0.0);
    options.directions = wish.directions.value_or(options.directions);
    options.texels = a.texels.value_or(options.texels);
    options.lights = a.lights.value_or(options.lights);
    options.samples = a.samples * paths_per_reflection;
    options.light.diffuse_samples = a.samples * paths_per_place;
    options.light.seed = a.seed.value_or(usual_bake_seed);
    options.run.threads = a.texture.threads;
    options.run.cancelled = [] { return interrupted_by() != 0; };
    return options;
}

void report(const BakeCommand& a, const corpus::ModelLayers& baked,
            const std::vector<CodedLayer>& coded, std::size_t bytes, double seconds) {
    if (a.encode.json) {
        Json json = {{"output", a.output},
                     {"bytes", bytes},
                     {"seconds", seconds},
                     {"triangles", baked.decoded_mesh.triangles.size()},
                     {"charts", baked.charts},
                     {"mesh_bytes", baked.mesh.size()},
                     {"texels_per_unit", baked.density},
                     {"lights", baked.lights.size()},
                     {"layers", Json::array()}};
        for (const CodedLayer& layer : coded)
            json["layers"].push_back({{"role", name_of(layer.texture->role)},
                                      {"size", to_string(layer.texture->desc.size)},
                                      {"bytes", layer.bytes.size()},
                                      {"psnr", layer.psnr}});
        print_json(json);
        return;
    }
    if (a.texture.quiet)
        return;
    std::FILE* const to = summary_stream(a.output);
    std::fprintf(to, "%s: %zu bytes in %.1f s\n", a.output.c_str(), bytes, seconds);
    std::fprintf(to, "  mesh        %zu triangles, %zu charts: %zu bytes\n",
                 baked.decoded_mesh.triangles.size(), baked.charts, baked.mesh.size());
    std::fprintf(to, "  lights      %zu\n", baked.lights.size());
    for (std::size_t i = 0; i < coded.size(); ++i) {
        const CodedLayer& layer = coded[i];
        const std::size_t own = layer.bytes.size() - (i == 0 ? baked.mesh.size() : 0);
        std::fprintf(to, "  %-11s %s: %zu bytes, %.1f dB\n", name_of(layer.texture->role),
                     to_string(layer.texture->desc.size).c_str(), own, layer.psnr);
    }
}

} // namespace

Status bake_layered(const BakeCommand& a) {
    if (!corpus::is_model_path(a.scene))
        return {ErrorCode::bad_argument,
                "--layered needs a model, not the built-in scene " + a.scene};
    TESSERA_TRY(check_model(a));
    TESSERA_TRY(check_layered(a));
    TESSERA_TRY(check_tess_output(a.encode, a.output));
    const auto start = std::chrono::steady_clock::now();
    TESSERA_TRY_ASSIGN(const corpus::SurfaceWish wish, surface_wish(a));
    TESSERA_TRY_ASSIGN(LitModelFile file, load_lit_model(a.scene, a.model));
    TESSERA_TRY_ASSIGN(const std::vector<std::string> notes, say_notes(a, file.model));
    TESSERA_TRY_ASSIGN(const corpus::Model model,
                       corpus::with_both_sides(std::move(file.model)).with_context(a.scene));
    corpus::ModelLayersOptions options = layer_options(a, wish, file.display.exposure);
    corpus::ModelLayers baked;
    std::vector<CodedLayer> coded;
    {
        Progress progress("tessera bake", a.texture.quiet || a.encode.json);
        options.run.progress = progress.function();
        TESSERA_TRY_ASSIGN(
            baked, corpus::bake_model_layers(model, file.light, options).with_context(a.scene));
        TESSERA_TRY_ASSIGN(
            EncodeOptions encode,
            make_encode_options(a.encode, a.texture.threads,
                                metadata_of(model_facts(a, file, baked.density, notes)), {}));
        encode.mesh = baked.mesh;
        encode.progress = options.run.progress;
        encode.cancelled = options.run.cancelled;
        for (const corpus::LayerTexture& texture : baked.layers) {
            TESSERA_TRY_ASSIGN(CodedLayer layer, encode_layer(a, texture, encode));
            coded.push_back(std::move(layer));
        }
    }
    TESSERA_TRY_ASSIGN(const std::vector<std::byte> bytes, join(baked, coded));
    TESSERA_TRY(write_bytes(a.output, bytes));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    report(a, baked, coded, bytes.size(), seconds.count());
    return {};
}

} // namespace tessera
