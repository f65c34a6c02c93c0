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
#include "tools/view/layered_renderer.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/outside_colour.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

// Small along s and t, because an observer sees each point from one direction only.
constexpr Extent4 lazy_block{8, 8, 4, 4};

// Per pixel. About as smooth as the GPU renderer's four samples.
constexpr unsigned mesh_rays = 4;

constexpr unsigned usual_truth_rays = 16;
constexpr unsigned usual_model_paths = 512;
// Display values are clipped after the paths of a ray have been averaged. Without several paths per
// ray, bright places would become too dark.
constexpr unsigned least_paths_per_ray = 4;

// Path traces the model, with the light and materials in the file's metadata.
Status add_model_truth(const StageRequest& r, const Metadata& metadata,
                       const glm::dvec3& background, const RenderOptions& asked, Stage& stage) {
    if (!metadata.contains("Model"))
        return {ErrorCode::bad_argument,
                r.file + ": was not baked from a model, but --truth " + r.truth + " is a model"};
    TESSERA_TRY_ASSIGN(ModelArguments arguments, arguments_in(metadata).with_context(r.file));
    if (!r.truth_environment.empty()) {
        arguments.environment = r.truth_environment;
        arguments.environment_layer.clear();
    }
    TESSERA_TRY_ASSIGN(LitModelFile file, load_lit_model(r.truth, arguments));
    file.light.backdrop = file.display.light(background);
    TESSERA_TRY_ASSIGN(const corpus::ModelFrame frame,
                       frame_of_mesh(file.model.frame, metadata).with_context(r.file));
    RenderOptions options = asked;
    const unsigned paths = r.truth_samples.value_or(usual_model_paths);
    // As many as the file is drawn with: with fewer, details smaller than a pixel would alias.
    options.rays = std::clamp(paths / least_paths_per_ray, 1u, std::max(mesh_rays, asked.rays));
    TESSERA_TRY_ASSIGN(const auto truth,
                       corpus::make_model_truth(std::move(file.model), std::move(file.light),
                                                file.display,
                                                (paths + options.rays - 1) / options.rays)
                           .with_context(r.truth));
    stage.truth = make_model_truth_renderer(truth, frame, background, options);
    return {};
}

Status add_truth(const StageRequest& r, const std::string& subject, const std::string& of_scene,
                 const RenderOptions& options, Stage& stage) {
    TESSERA_TRY(check_scene(r.truth).with_context("--truth"));
    TESSERA_TRY_ASSIGN(auto scene, corpus::make_scene(r.truth));
    if (!of_scene.empty() && of_scene != r.truth)
        return {ErrorCode::bad_argument,
                subject + ": was baked from the scene " + of_scene + ", not " + r.truth};
    if (scene.type != stage.desc.type)
        return {ErrorCode::bad_argument, subject + ": has samples of type " +
                                             name_of(stage.desc.type) + ", but the scene " +
                                             r.truth + " has " + name_of(scene.type)};
    stage.truth = make_truth_renderer(std::move(scene), stage.window,
                                      r.truth_samples.value_or(usual_truth_rays), options);
    return {};
}

// Network sources count their requests themselves, which is more precise than counting reads.
Traffic traffic_of(const ByteSource& bytes, const MeteredSource& metered) {
    return network_traffic(bytes).value_or(metered.traffic());
}

// What all renderers of a file need besides the stage.
struct FileSurface {
    std::optional<MeshSurface> mesh; // absent for spheres and planar views
    glm::dvec3 background{0.0};
    RenderOptions options;
};

Status open_texture_of(const StageRequest& r, Stage& stage) {
    if (!r.bytes.empty()) {
        stage.bytes = wrap_memory(r.bytes);
    } else {
        TESSERA_TRY_ASSIGN(stage.bytes, open_tess_bytes(r.file, "render"));
    }
    stage.metered = std::make_unique<MeteredSource>(*stage.bytes);
    const bool is_remote = network_traffic(*stage.bytes).has_value();
    auto decoder = Decoder::open(is_remote ? *stage.bytes : *stage.metered, r.decode);
    if (!decoder.ok())
        return with_partial_hint(decoder.status(), *stage.bytes, r.decode);
    stage.decoder = std::make_unique<Decoder>(std::move(*decoder));
    stage.desc = stage.decoder->desc();
    return {};
}

// Meshes of models and photographs have their own units and place. Those that fill the sphere of
// the paper's scene are seen as that scene. As defaultPose() in tools/web/viewer/surfaces.js.
ViewFrame frame_of(const SurfaceMesh& mesh) {
    constexpr double paper_extent = 3.6, least_radius = 2.0, most_away = 1.0;
    const MeshBounds bounds = bounds_of(mesh);
    const glm::dvec3 far = glm::max(-bounds.low, bounds.high), centre = bounds.centre();
    double radius = 0.0;
    for (const glm::vec3& p : mesh.positions)
        radius = std::max(radius, glm::length(glm::dvec3(p) - centre));
    if (std::max({far.x, far.y, far.z}) <= paper_extent && radius >= least_radius &&
        glm::length(centre) <= most_away)
        return {};
    return {centre, radius / corpus::paper_radius};
}

Status find_surface(const StageRequest& r, const RenderOptions& options, Stage& stage,
                    FileSurface& surface) {
    const ContainerReader& container = stage.decoder->container();
    TESSERA_TRY_ASSIGN(surface.mesh, mesh_surface(container));
    TESSERA_TRY_ASSIGN(stage.planar, planar_views(container, r.focus));
    if (!stage.planar && r.focus)
        return {ErrorCode::bad_argument, "--focus can only be used with planar views"};
    if (surface.mesh && !container.metadata().contains("Scene"))
        stage.frame = frame_of(surface.mesh->mesh);
    if (stage.planar && (r.via != "cpu" || !r.truth.empty()))
        return {ErrorCode::unsupported,
                r.file + ": planar views need --via cpu and cannot be compared with --truth"};
    if (!surface.mesh && !stage.planar) {
        TESSERA_TRY_ASSIGN(stage.window,
                           sphere_window(container.description()).with_context(r.file));
    }
    TESSERA_TRY_ASSIGN(surface.background, outside_colour(container));
    surface.options = options;
    surface.options.rays = r.rays.value_or(surface.mesh ? mesh_rays : 1);
    return {};
}

Status add_file_truth(const StageRequest& r, const FileSurface& surface, Stage& stage) {
    const Metadata& metadata = stage.decoder->container().metadata();
    if (r.truth.empty())
        return {};
    if (corpus::is_model_path(r.truth))
        return add_model_truth(r, metadata, surface.background, surface.options, stage);
    if (const auto model = metadata.find("Model"); model != metadata.end())
        return {ErrorCode::bad_argument, r.file + ": was baked from the model " + model->second +
                                             ", not from the scene " + r.truth};
    const auto scene = metadata.find("Scene");
    return add_truth(r, r.file, scene == metadata.end() ? "" : scene->second, surface.options,
                     stage);
}

Result<std::unique_ptr<ViewRenderer>> cpu_renderer(const Stage& stage, const FileSurface& surface,
                                                   TexelSource& texels, const AlignedViews& aligned,
                                                   const Extent4& block,
                                                   const RenderOptions& options) {
    if (surface.mesh)
        return make_mesh_renderer(texels, block, *surface.mesh, surface.background, options);
    if (stage.planar)
        return make_planar_renderer(texels, block, *stage.planar, aligned, surface.background,
                                    options);
    return make_texture_renderer(texels, block, *stage.window, surface.background, options);
}

Status add_cpu_renderer(const FileSurface& surface, Stage& stage) {
    const ContainerReader& container = stage.decoder->container();
    stage.texels = decoded_grid(*stage.decoder);
    RenderOptions options = surface.options;
    if (container.wants_prefetch())
        options.foretell = [&container](std::span<const std::uint64_t> tiles) {
            return container.prefetch(tiles).status();
        };
    // Its blocks are the tiles of the file.
    TESSERA_TRY_ASSIGN(stage.compressed,
                       cpu_renderer(stage, surface, *stage.texels, container.aligned_views(),
                                    container.grid().tile_extent(), options));
    return {};
}

// The coarsest level of a file, if it has any. It decodes fastest, and the device's coarse texels
// are no finer. The texels are added to `kept`.
CoarseLevel coarsest_level(const Decoder& decoder,
                           std::vector<std::unique_ptr<TexelSource>>& kept) {
    const auto& levels = decoder.container().levels();
    if (levels.size() < 2)
        return {};
    kept.push_back(decoded_level(decoder, levels.size() - 1));
    return {levels.back(), kept.back().get()};
}

GpuRenderOptions gpu_options(const StageRequest& r, const Stage& stage) {
    GpuRenderOptions options;
    options.via = r.via;
    options.budget_mib = r.budget_mib;
    options.tiles_per_frame = r.tiles_per_frame;
    // Captures these two, because the stage itself may move.
    options.traffic = [bytes = stage.bytes.get(), metered = stage.metered.get()] {
        return traffic_of(*bytes, *metered);
    };
    return options;
}

Status add_layers_on_gpu(const StageRequest& r, const FileSurface& surface, Stage& stage) {
    const ContainerReader& container = stage.decoder->container();
    std::vector<std::unique_ptr<TexelSource>> coarse;
    std::vector<GpuLayer> drawn = {{LayerRole::diffuse, container.layers().scale, &container,
                                    coarsest_level(*stage.decoder, coarse)}};
    for (const OpenLayerFile& layer : stage.layers)
        drawn.push_back({layer.info.role, layer.info.scale, &layer.decoder->container(),
                         coarsest_level(*layer.decoder, coarse)});
    TESSERA_TRY_ASSIGN(stage.compressed,
                       make_gpu_renderer(drawn, container.layers().lights, surface.mesh->mesh,
                                         surface.background, gpu_options(r, stage)));
    return {};
}

Status add_layers_on_cpu(const FileSurface& surface, Stage& stage) {
    const ContainerReader& container = stage.decoder->container();
    stage.texels = decoded_grid(*stage.decoder);
    std::vector<DrawnLayer> drawn = {
        {LayerRole::diffuse, static_cast<double>(container.layers().scale), stage.texels.get(),
         container.grid().tile_extent(), container.description().transfer}};
    for (const OpenLayerFile& layer : stage.layers) {
        const ContainerReader& own = layer.decoder->container();
        // Encoders used to align directions of some layers as if they were views.
        stage.layer_texels.push_back(decoded_source(*layer.decoder));
        drawn.push_back({layer.info.role, static_cast<double>(layer.info.scale),
                         stage.layer_texels.back().get(), own.grid().tile_extent(),
                         own.description().transfer});
    }
    TESSERA_TRY_ASSIGN(stage.compressed,
                       make_layered_renderer(drawn, container.layers().lights, surface.mesh->mesh,
                                             surface.background, surface.options));
    return {};
}

// Draws all layers of the file.
Status add_layered_renderer(const StageRequest& r, const FileSurface& surface, Stage& stage) {
    const ContainerReader& container = stage.decoder->container();
    if (!surface.mesh)
        return {ErrorCode::unsupported, r.file + ": its layers do not lie on a mesh"};
    if (!r.original.empty())
        return {ErrorCode::unsupported, r.file + ": --original cannot be used with layers"};
    const bool is_remote = network_traffic(*stage.bytes).has_value();
    TESSERA_TRY_ASSIGN(stage.layers,
                       open_layers(is_remote ? *stage.bytes : *stage.metered, container, r.decode));
    return r.via == "cpu" ? add_layers_on_cpu(surface, stage)
                          : add_layers_on_gpu(r, surface, stage);
}

Status add_gpu_renderer(const StageRequest& r, const FileSurface& surface, Stage& stage) {
    const ContainerReader& container = stage.decoder->container();
    std::vector<std::unique_ptr<TexelSource>> coarse;
    GpuRenderOptions options = gpu_options(r, stage);
    options.coarse = coarsest_level(*stage.decoder, coarse);
    TESSERA_TRY_ASSIGN(
        stage.compressed,
        surface.mesh ? make_gpu_renderer(container, surface.mesh->mesh, surface.background, options)
                     : make_gpu_renderer(container, *stage.window, surface.background, options));
    return {};
}

// Adds the uncompressed texture if the request compares the file with it.
Status add_original(const StageRequest& r, const FileSurface& surface, Stage& stage) {
    // Textures of meshes are never baked again.
    if (r.original.empty() && (r.truth.empty() || surface.mesh))
        return {};
    const ContainerReader& container = stage.decoder->container();
    TESSERA_TRY_ASSIGN(auto original,
                       !r.original.empty()
                           ? open_original(r.original, stage.desc)
                           : bake_again({r.truth, r.samples, std::nullopt}, r.file, stage.desc.size,
                                        container.description(), container.metadata()));
    if (original->desc() != stage.desc)
        return {ErrorCode::bad_argument,
                r.file + ": its sample type or number of channels is not that of " +
                    (r.original.empty() ? "the scene " + r.truth : r.original)};
    stage.original = std::move(original);
    TESSERA_TRY_ASSIGN(stage.uncompressed, cpu_renderer(stage, surface, *stage.original,
                                                        AlignedViews(stage.desc.size, {}),
                                                        lazy_block, surface.options));
    return {};
}

Status add_file(const StageRequest& r, const RenderOptions& options, Stage& stage) {
    FileSurface surface;
    TESSERA_TRY(open_texture_of(r, stage));
    TESSERA_TRY(find_surface(r, options, stage, surface));
    TESSERA_TRY(add_file_truth(r, surface, stage));
    TESSERA_TRY(stage.decoder->container().layers().any() ? add_layered_renderer(r, surface, stage)
                : r.via == "cpu"                          ? add_cpu_renderer(surface, stage)
                                                          : add_gpu_renderer(r, surface, stage));
    return add_original(r, surface, stage);
}

// Draws the texture of a scene without a file. Its size does not matter, because only the texels in
// view are baked.
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
        return {ErrorCode::bad_argument, "give a .tess file or --scene, but not both"};
    if (r.file.empty() && (r.via != "cpu" || !r.original.empty()))
        return {ErrorCode::bad_argument,
                "--via and --original need a .tess file; --scene is drawn on the CPU"};
    if (r.decode.allow_damaged && r.via != "cpu")
        return {ErrorCode::bad_argument, "--allow-damaged can only be used with --via cpu"};
    if (r.decode.allow_partial && r.via != "cpu" && r.via != "feedback")
        return {ErrorCode::bad_argument,
                "--allow-partial can only be used with --via cpu or feedback"};
    if (!r.truth_environment.empty() && !corpus::is_model_path(r.truth))
        return {ErrorCode::bad_argument, "--env can only be used with --truth MODEL"};
    if (r.file.empty() && corpus::is_model_path(r.truth))
        return {ErrorCode::bad_argument,
                "--truth " + r.truth + ": a model needs a .tess file that was baked from it"};
    if (!r.file.empty() && !r.texture_size.empty())
        return {ErrorCode::bad_argument,
                "--size can only be used with --scene; --pixels sets the size of the picture"};
    if (r.samples && !r.original.empty())
        return {ErrorCode::bad_argument,
                "--spp cannot be used with --original, because that texture is not baked"};
    if (r.samples && r.truth.empty() && r.scene.empty())
        return {ErrorCode::bad_argument,
                "--spp needs --truth or --scene, because nothing is baked without them"};
    if (r.tiles_per_frame > 0 && r.via != "feedback")
        return {ErrorCode::bad_argument, "--tiles-per-frame can only be used with --via feedback"};
    return {};
}

} // namespace

Result<std::unique_ptr<TexelSource>> open_original(const std::string& path,
                                                   const TextureDesc& desc) {
    const TextureKind kind = kind_of_input(path);
    if (kind != TextureKind::raw && kind != TextureKind::tess)
        return Status(ErrorCode::bad_argument,
                      path + ": --original must be a raw file or a .tess file, because its texels "
                             "are read in any order");
    TextureHints hints;
    hints.size = desc.size;
    hints.type = desc.type;
    hints.channels = desc.channels;
    TESSERA_TRY_ASSIGN(auto opened, open_texture(path, hints));
    return std::move(opened.source);
}

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
