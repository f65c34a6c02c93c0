#include "tools/view/render_stage.h"

#include "corpus/bake.h"
#include "tools/http/open_bytes.h"
#include "tools/scenes/baked_original.h"
#include "tools/scenes/lit_model_file.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/fill_text.h"
#include "tools/support/parse.h"
#include "tools/texture_io/texture_io.h"
#include "tools/view/gpu_renderer.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/outside_colour.h"

namespace tessera {
namespace {

// Small along s and t: an observer sees each place from one direction.
constexpr Extent4 lazy_block{8, 8, 4, 4};

// Evenly spread, about as smooth as the multisampling of a GPU.
constexpr unsigned mesh_rays = 4;

constexpr unsigned usual_truth_rays = 16;
constexpr unsigned usual_model_paths = 512;

Result<std::unique_ptr<TexelSource>> open_original(const StageRequest& r, const Stage& stage) {
    const TextureKind kind = kind_of_input(r.original);
    if (kind != TextureKind::raw && kind != TextureKind::tess)
        return Status(ErrorCode::bad_argument,
                      r.original + ": --original takes a raw file or a .tess, whose texels can be "
                                   "read in any order");
    TextureHints hints;
    hints.size = stage.desc.size;
    hints.type = stage.desc.type;
    hints.channels = stage.desc.channels;
    TESSERA_TRY_ASSIGN(auto opened, open_texture(r.original, hints));
    return std::move(opened.source);
}

// The model that a texture was made of, in the light that the file says.
Status add_model_truth(const StageRequest& r, const Metadata& metadata,
                       const glm::dvec3& background, const RenderOptions& asked, Stage& stage) {
    if (!metadata.contains("Model"))
        return {ErrorCode::bad_argument,
                r.file + ": is not of a model, but --truth " + r.truth + " is one"};
    TESSERA_TRY_ASSIGN(ModelArguments arguments, arguments_in(metadata).with_context(r.file));
    if (!r.truth_environment.empty())
        arguments.environment = r.truth_environment;
    TESSERA_TRY_ASSIGN(LitModelFile file, load_lit_model(r.truth, arguments));
    RenderOptions options = asked;
    const unsigned paths = r.truth_samples.value_or(usual_model_paths);
    options.rays = std::min(mesh_rays, paths);
    TESSERA_TRY_ASSIGN(const auto truth,
                       corpus::make_model_truth(std::move(file.model), std::move(file.light),
                                                file.display,
                                                (paths + options.rays - 1) / options.rays)
                           .with_context(r.truth));
    stage.truth = make_model_truth_renderer(truth, background, options);
    return {};
}

Status add_truth(const StageRequest& r, const std::string& subject, const std::string& of_scene,
                 const RenderOptions& options, Stage& stage) {
    TESSERA_TRY(check_scene(r.truth).with_context("--truth"));
    TESSERA_TRY_ASSIGN(auto scene, corpus::make_scene(r.truth));
    if (!of_scene.empty() && of_scene != r.truth)
        return {ErrorCode::bad_argument,
                subject + ": is of the scene " + of_scene + ", not " + r.truth};
    if (scene.type != stage.desc.type)
        return {ErrorCode::bad_argument, subject + ": is " + name_of(stage.desc.type) +
                                             ", and the scene " + r.truth + " is " +
                                             name_of(scene.type)};
    stage.truth = make_truth_renderer(std::move(scene), stage.window,
                                      r.truth_samples.value_or(usual_truth_rays), options);
    return {};
}

// The network counts its requests itself, by a finer measure than reads.
Traffic traffic_of(const ByteSource& bytes, const MeteredSource& metered) {
    return network_traffic(bytes).value_or(metered.traffic());
}

// A compressed file, and the texture that it was made from where there is something to compare.
Status add_file(const StageRequest& r, const RenderOptions& asked, Stage& stage) {
    TESSERA_TRY_ASSIGN(stage.bytes, open_tess_bytes(r.file, "render"));
    stage.metered = std::make_unique<MeteredSource>(*stage.bytes);
    const bool remote = network_traffic(*stage.bytes).has_value();
    auto decoder = Decoder::open(remote ? *stage.bytes : *stage.metered, r.decode);
    if (!decoder.ok())
        return with_partial_hint(decoder.status(), *stage.bytes, r.decode);
    stage.decoder = std::make_unique<Decoder>(std::move(*decoder));
    stage.desc = stage.decoder->desc();
    const ContainerReader& container = stage.decoder->container();
    TESSERA_TRY_ASSIGN(const auto mesh, mesh_surface(container));
    TESSERA_TRY_ASSIGN(stage.planar, planar_views(container, r.focus));
    if (!stage.planar && r.focus)
        return {ErrorCode::bad_argument, "--focus belongs to planar views"};
    if (stage.planar && (r.via != "cpu" || !r.truth.empty()))
        return {ErrorCode::unsupported,
                r.file + ": planar views are drawn by --via cpu, and are of no built-in scene"};
    if (!mesh && !stage.planar) {
        TESSERA_TRY_ASSIGN(stage.window,
                           sphere_window(container.description()).with_context(r.file));
    }
    TESSERA_TRY_ASSIGN(const glm::dvec3 background, outside_colour(container));
    RenderOptions options = asked;
    options.rays = r.rays.value_or(mesh ? mesh_rays : 1);
    const auto on_cpu = [&](TexelSource& texels, const AlignedViews& aligned, const Extent4& block,
                            const RenderOptions& use) -> Result<std::unique_ptr<ViewRenderer>> {
        if (mesh)
            return make_mesh_renderer(texels, block, *mesh, background, use);
        if (stage.planar)
            return make_planar_renderer(texels, block, *stage.planar, aligned, background, use);
        return make_texture_renderer(texels, block, *stage.window, background, use);
    };
    if (corpus::is_model_path(r.truth)) {
        TESSERA_TRY(add_model_truth(r, container.metadata(), background, options, stage));
    } else if (!r.truth.empty()) {
        const auto said = container.metadata().find("Scene");
        if (container.metadata().contains("Model"))
            return {ErrorCode::bad_argument, r.file + ": is of the model " +
                                                 container.metadata().find("Model")->second +
                                                 ", not of the scene " + r.truth};
        TESSERA_TRY(add_truth(r, r.file, said == container.metadata().end() ? "" : said->second,
                              options, stage));
    }
    if (r.via == "cpu") {
        stage.texels = decoded_grid(*stage.decoder);
        RenderOptions tile_by_tile = options; // blocks of the file's own grid
        if (container.wants_prefetch())
            tile_by_tile.foretell = [&container](std::span<const std::uint64_t> tiles) {
                return container.prefetch(tiles).status();
            };
        TESSERA_TRY_ASSIGN(stage.compressed, on_cpu(*stage.texels, container.aligned_views(),
                                                    container.grid().tile_extent(), tile_by_tile));
    } else {
        // The coarsest level is the cheapest and as fine as the device's coarse texels.
        std::unique_ptr<TexelSource> coarse;
        GpuRenderOptions on_gpu{r.via, r.budget_mib, r.tiles_per_frame, {}, nullptr, {}};
        on_gpu.traffic = [bytes = stage.bytes.get(), metered = stage.metered.get()] {
            return traffic_of(*bytes, *metered); // the stage may move
        };
        if (const std::size_t levels = container.levels().size(); levels > 1) {
            coarse = decoded_level(*stage.decoder, levels - 1);
            on_gpu.coarse_level = container.levels().back();
            on_gpu.coarse_texels = coarse.get();
        }
        TESSERA_TRY_ASSIGN(stage.compressed,
                           mesh ? make_gpu_renderer(container, mesh->mesh, background, on_gpu)
                                : make_gpu_renderer(container, *stage.window, background, on_gpu));
    }
    // A mesh's texture is not baked again to be compared with.
    if (r.original.empty() && (r.truth.empty() || mesh))
        return {};
    TESSERA_TRY_ASSIGN(auto original,
                       !r.original.empty()
                           ? open_original(r, stage)
                           : bake_again({r.truth, r.samples, std::nullopt}, r.file, stage.desc.size,
                                        container.description(), container.metadata()));
    if (original->desc() != stage.desc)
        return {ErrorCode::bad_argument,
                r.file + ": its samples are not of the type or number of those of " +
                    (r.original.empty() ? "the scene " + r.truth : r.original)};
    stage.original = std::move(original);
    TESSERA_TRY_ASSIGN(
        stage.uncompressed,
        on_cpu(*stage.original, AlignedViews(stage.desc.size, {}), lazy_block, options));
    return {};
}

// A texture that no file holds: of any size, as only what is looked at is ever made.
Status add_scene(const StageRequest& r, const RenderOptions& asked, Stage& stage) {
    TESSERA_TRY(check_scene(r.scene).with_context("--scene"));
    TESSERA_TRY_ASSIGN(const auto info, corpus::find_scene(r.scene));
    TESSERA_TRY_ASSIGN(const auto size,
                       parse_extent_or(r.texture_size, "--size", info.default_size));
    TESSERA_TRY_ASSIGN(stage.original, corpus::make_baked_source(
                                           r.scene, size, r.samples.value_or(usual_samples), 1)
                                           .with_context("--scene " + r.scene));
    stage.desc = stage.original->desc();
    stage.window = SphereWindow{};
    RenderOptions options = asked;
    options.rays = r.rays.value_or(1);
    if (!r.truth.empty())
        TESSERA_TRY(add_truth(r, "--scene", r.scene, options, stage));
    TESSERA_TRY_ASSIGN(const auto scene, corpus::make_scene(r.scene));
    stage.uncompressed = make_texture_renderer(*stage.original, lazy_block, *stage.window,
                                               scene.background, options);
    return {};
}

Status check_request(const StageRequest& r) {
    if (r.file.empty() == r.scene.empty())
        return {ErrorCode::bad_argument, "a .tess file or --scene is needed, and not both"};
    if (r.file.empty() && (r.via != "cpu" || !r.original.empty()))
        return {ErrorCode::bad_argument,
                "--via and --original belong to a .tess file; --scene is drawn on the CPU"};
    if (r.decode.allow_damaged && r.via != "cpu")
        return {ErrorCode::bad_argument, "--allow-damaged needs --via cpu"};
    if (r.decode.allow_partial && r.via != "cpu" && r.via != "feedback")
        return {ErrorCode::bad_argument, "--allow-partial needs --via cpu or feedback"};
    if (!r.truth_environment.empty() && !corpus::is_model_path(r.truth))
        return {ErrorCode::bad_argument, "--env belongs to --truth MODEL"};
    if (r.file.empty() && corpus::is_model_path(r.truth))
        return {ErrorCode::bad_argument, "--truth " + r.truth + ": a model needs a .tess of it"};
    if (!r.file.empty() && !r.texture_size.empty())
        return {ErrorCode::bad_argument, "--size belongs to --scene; --pixels is the size of the picture"};
    if (r.samples && !r.original.empty())
        return {ErrorCode::bad_argument, "--spp: the texture of --original is not baked"};
    if (r.samples && r.truth.empty() && r.scene.empty())
        return {ErrorCode::bad_argument, "--spp belongs to --truth or --scene: nothing is baked"};
    if (r.tiles_per_frame > 0 && r.via != "feedback")
        return {ErrorCode::bad_argument, "--tiles-per-frame belongs to --via feedback"};
    return {};
}

} // namespace

Traffic Stage::traffic() const {
    return !bytes ? Traffic{} : traffic_of(*bytes, *metered);
}

Result<Stage> set_up_stage(const StageRequest& request, const RenderOptions& options) {
    TESSERA_TRY(check_request(request));
    Stage stage;
    TESSERA_TRY(request.file.empty() ? add_scene(request, options, stage)
                                     : add_file(request, options, stage));
    return stage;
}

} // namespace tessera
