#include "tools/lab/rd/views_study.h"

#include "codec/encoder.h"
#include "corpus/bake.h"
#include "corpus/catalog.h"
#include "corpus/layers/scene_layers.h"
#include "corpus/surface/scene_surface.h"
#include "format/output_file.h"
#include "tools/lab/rd/curve_plot.h"
#include "tools/lab/rd/scratch_folder.h"
#include "tools/lab/rd/view_poses.h"
#include "tools/scenes/baked_original.h"
#include "tools/scenes/baked_surface.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/interrupt.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/verbs/encode_layers.h"
#include "tools/view/render_stage.h"
#include "tools/view/view_file.h"
#include "tools/view/view_report.h"

#include <chrono>
#include <cstdio>
#include <filesystem>

namespace tessera {
namespace {

constexpr unsigned truth_rays = 16;
constexpr unsigned observers = 32;
constexpr double nearest = 6, farthest = 30;

// A kind of surface that carries a texture of the scene, with the qualities to measure.
struct Carrier {
    std::string name;
    std::optional<corpus::SurfaceWish> surface; // absent: the paper's sphere
    Extent4 size{0, 0, 0, 0};                   // texture size, for the sphere only
    std::vector<double> qualities;
    bool layered = false; // colours, and differences by direction
};

// `shines`: whether layers can hold the scene, and something shines in it.
std::vector<Carrier> carriers_of(const ViewsOptions& o, bool shines) {
    std::vector<Carrier> all;
    const auto surface = [&](const char* family, unsigned density, std::uint32_t directions,
                             std::vector<double> qualities) {
        corpus::SurfaceWish wish;
        wish.density = density;
        wish.directions = {directions, directions};
        std::string name = std::string(family) + ":" + std::to_string(density);
        if (directions > 1)
            name += " " + std::to_string(directions) + "x" + std::to_string(directions);
        all.push_back({std::move(name), wish, {}, std::move(qualities), false});
    };
    const auto sphere = [&](const Extent4& size) {
        all.push_back({"sphere:" + to_string(size), std::nullopt, size, {50, 62}, false});
    };
    const auto layers = [&](unsigned density, std::uint32_t directions,
                            std::vector<double> qualities) {
        if (!shines)
            return;
        surface("layers", density, directions, std::move(qualities));
        all.back().layered = true;
    };
    if (o.quick) {
        layers(32, 24, {40, 56});
        surface("surface", 16, 8, {40, 56});
        surface("plain", 16, 1, {50, 70});
        sphere({64, 32, 16, 16});
        return all;
    }
    layers(32, 16, {40, 50, 60});
    layers(32, 24, {36, 44, 52, 60, 68});
    layers(64, 24, {44, 52, 60, 68});
    layers(64, 32, {44, 52, 60, 68});
    surface("surface", 16, 24, {32, 40, 48, 56});
    surface("surface", 16, 16, {36, 46, 56});
    surface("surface", 32, 24, {40, 50, 60, 70});
    surface("surface", 32, 16, {36, 44, 52, 60, 68});
    surface("surface", 32, 8, {36, 46, 56});
    surface("surface", 64, 16, {36, 46, 56});
    surface("plain", 32, 1, {40, 56, 72});
    surface("plain", 64, 1, {40, 56, 72});
    // The paper's texture sizes with 403 MB of raw data.
    for (const Extent4& size : {Extent4{512, 256, 32, 32}, Extent4{256, 128, 64, 64},
                                Extent4{128, 64, 128, 128}, Extent4{64, 32, 256, 256}})
        sphere(size);
    return all;
}

// Renders views of the scene by direct ray tracing and compares the views of a file with them.
class Judge {
public:
    static Result<Judge> make(const ViewsOptions& o) {
        Judge judge;
        TESSERA_TRY_ASSIGN(judge.paper_, paper_cameras());
        TESSERA_TRY_ASSIGN(judge.spread_, spread_cameras(observers, nearest, farthest));
        TESSERA_TRY_ASSIGN(auto scene, corpus::make_scene(o.scene));
        judge.type_ = scene.type;
        judge.options_.threads = o.threads;
        const auto truth =
            make_truth_renderer(std::move(scene), std::nullopt, truth_rays, judge.options_);
        TESSERA_TRY_ASSIGN(judge.paper_truth_, judge.draw(*truth, judge.paper_));
        TESSERA_TRY_ASSIGN(judge.spread_truth_, judge.draw(*truth, judge.spread_));
        return judge;
    }

    Status measure(const std::string& file, ViewsRow& row) const {
        StageRequest request;
        request.file = file;
        TESSERA_TRY_ASSIGN(const Stage stage, set_up_stage(request, options_));
        TESSERA_TRY_ASSIGN(row.paper, likeness(stage.subject(), paper_, paper_truth_));
        TESSERA_TRY_ASSIGN(row.spread, likeness(stage.subject(), spread_, spread_truth_));
        return {};
    }

private:
    Result<std::vector<Picture>> draw(ViewRenderer& renderer,
                                      const std::vector<Camera>& cameras) const {
        std::vector<Picture> pictures;
        for (const Camera& camera : cameras) {
            TESSERA_TRY_ASSIGN(const View view, renderer.render(camera));
            pictures.push_back(to_picture(view, type_));
        }
        return pictures;
    }
    Result<SeenQuality> likeness(ViewRenderer& renderer, const std::vector<Camera>& cameras,
                                 const std::vector<Picture>& truth) const {
        TESSERA_TRY_ASSIGN(const auto pictures, draw(renderer, cameras));
        SeenQuality mean;
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            const Likeness one = likeness_of(truth[i], pictures[i]);
            mean.psnr += one.psnr / static_cast<double>(pictures.size());
            mean.ssim += one.ssim / static_cast<double>(pictures.size());
        }
        return mean;
    }

    std::vector<Camera> paper_, spread_;
    std::vector<Picture> paper_truth_, spread_truth_;
    SampleType type_ = SampleType::unorm8;
    RenderOptions options_;
};

struct Baked {
    std::unique_ptr<TexelSource> texels, mask;
    EncodeOptions options;
};

// Runs again for each quality: most of the time goes into rendering views.
Result<Baked> bake(const Carrier& carrier, const std::string& scene) {
    Baked baked;
    Description& d = baked.options.description;
    if (!carrier.surface) {
        TESSERA_TRY_ASSIGN(baked.texels,
                           corpus::make_baked_source(scene, carrier.size, usual_samples, 1));
        d.proxy = Proxy::sphere;
        d.sphere_radius = static_cast<float>(corpus::window_radius);
        d.surface_map = SurfaceMap::sphere_longitude_latitude;
        d.angular_map = AngularMap::hemisphere_alpha_beta;
        return baked;
    }
    TESSERA_TRY_ASSIGN(BakedSurface surface,
                       bake_surface({scene, *carrier.surface, std::nullopt, usual_samples}));
    baked.texels = std::move(surface.texels);
    baked.mask = std::move(surface.mask);
    baked.options.mask = baked.mask.get();
    baked.options.mesh = std::move(surface.mesh);
    baked.options.tile_extent = surface.detail.tile;
    baked.options.metadata["Background"] = surface.background;
    d.proxy = Proxy::mesh;
    d.surface_map = SurfaceMap::mesh_uv;
    d.angular_map = surface.map;
    return baked;
}

// Writes the texture and says what it is in the report's row.
Status write_texture(const Carrier& carrier, double quality, const ViewsOptions& o,
                     const ProgressFunction& progress, const std::string& file, ViewsRow& row) {
    TESSERA_TRY_ASSIGN(Baked baked, bake(carrier, o.scene));
    EncodeOptions& options = baked.options;
    options.rate = {RateTarget::Kind::quality, quality};
    options.effort = o.effort;
    options.threads = o.threads;
    options.verify = false;
    options.progress = progress;
    const auto source = interruptible(std::move(baked.texels));
    TESSERA_TRY_ASSIGN(const EncodeReport report, encode_file(*source, file, options));
    row.size = to_string(source->desc().size);
    row.raw_bytes = source->desc().box_bytes(Box4::whole(source->desc().size));
    row.bytes = report.file_bytes;
    return {};
}

Status write_layered(const Carrier& carrier, double quality, const ViewsOptions& o,
                     const ProgressFunction& progress, const std::string& file, ViewsRow& row) {
    TESSERA_TRY_ASSIGN(const corpus::Scene made, corpus::make_scene(o.scene));
    const corpus::Scene scene = corpus::with_surfaces(made);
    corpus::SceneLayersOptions bake{.wish = *carrier.surface, .samples = usual_samples, .run = {}};
    bake.run = {.threads = o.threads, .progress = progress, .cancelled = [] {
                    return interrupted_by() != 0;
                }};
    TESSERA_TRY_ASSIGN(const corpus::ModelLayers layers, corpus::bake_scene_layers(scene, bake));
    EncodeOptions options;
    options.effort = o.effort;
    options.threads = o.threads;
    options.verify = false;
    options.progress = progress;
    options.cancelled = bake.run.cancelled;
    options.mesh = layers.mesh;
    options.metadata["Background"] = background_fact(scene);
    TESSERA_TRY_ASSIGN(const CodedLayers coded,
                       encode_layers(layers, options, {.quality = quality}));
    for (const corpus::LayerTexture& layer : layers.layers) {
        row.size += (row.size.empty() ? "" : " + ") + to_string(layer.desc.size);
        row.raw_bytes += layer.texels.size();
    }
    row.bytes = coded.file.size();
    return write_bytes(file, coded.file);
}

Result<ViewsRow> measure(const Carrier& carrier, double quality, const ViewsOptions& o,
                         const Judge& judge, const ProgressFunction& progress) {
    TESSERA_TRY_ASSIGN(ScratchFolder folder, ScratchFolder::create());
    const std::string file = folder.at("texture.tess");
    const auto start = std::chrono::steady_clock::now();
    ViewsRow row;
    TESSERA_TRY((carrier.layered ? write_layered : write_texture)(carrier, quality, o, progress,
                                                                  file, row));
    row.carrier = carrier.name;
    row.setting = "quality " + format_number(quality, 0);
    row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    TESSERA_TRY(judge.measure(file, row));
    return row;
}

void print_line(const ViewsRow& row) {
    std::printf("%-22s %-11s %9llu bytes  paper's views %6.2f dB, views all around %6.2f dB\n",
                row.carrier.c_str(), row.setting.c_str(),
                static_cast<unsigned long long>(row.bytes), row.paper.psnr, row.spread.psnr);
    std::fflush(stdout);
}

std::string svg_of(const ViewsReport& report) {
    std::vector<PlotCurve> curves;
    for (const ViewsRow& row : report.rows) {
        if (curves.empty() || curves.back().id != row.carrier)
            curves.push_back({row.carrier, {}});
        curves.back().points.push_back({static_cast<double>(row.bytes), row.paper.psnr,
                                        row.carrier + ", " + row.setting + ": " +
                                            human_bytes(row.bytes) + ", " +
                                            format_number(row.paper.psnr, 2) + " dB"});
    }
    return curves_to_svg(
        curves, {report.scene + ": quality of rendered views",
                 "Mean of the paper's five views against a direct ray trace. Up and to the left is "
                 "better.",
                 "bytes of the whole file (logarithmic)", "PSNR of views, dB"});
}

std::string to_csv(const ViewsReport& report) {
    std::string csv = "carrier,setting,texture,raw_bytes,bytes,paper_psnr,paper_ssim,around_psnr,"
                      "around_ssim,seconds\n";
    for (const ViewsRow& r : report.rows)
        csv += r.carrier + "," + r.setting + "," + r.size + "," + std::to_string(r.raw_bytes) +
               "," + std::to_string(r.bytes) + "," + format_number(r.paper.psnr, 3) + "," +
               format_number(r.paper.ssim, 4) + "," + format_number(r.spread.psnr, 3) + "," +
               format_number(r.spread.ssim, 4) + "," + format_number(r.seconds, 1) + "\n";
    return csv;
}

Status write_reports(const ViewsOptions& o, const ViewsReport& report) {
    const auto write = [&](const char* name, const std::string& text) {
        return write_bytes((to_path(o.output) / name).string(), std::as_bytes(std::span(text)));
    };
    TESSERA_TRY(write("views.svg", svg_of(report)));
    TESSERA_TRY(write("views.md", to_text(report)));
    TESSERA_TRY(write("views.csv", to_csv(report)));
    return write("views.json", to_json(report).dump(2) + "\n");
}

} // namespace

Result<ViewsReport> run_views_study(const ViewsOptions& options) {
    TESSERA_TRY(check_scene(options.scene).with_context("--views"));
    TESSERA_TRY(make_parent_folders((to_path(options.output) / "views.svg").string()));
    ViewsReport report{options.scene,
                       "tessera rd --views " + options.scene + (options.quick ? " --quick" : "") +
                           " -o " + options.output,
                       {}};
    TESSERA_TRY_ASSIGN(const corpus::Scene scene, corpus::make_scene(options.scene));
    const std::vector<Carrier> carriers =
        carriers_of(options, corpus::any_shines(scene) && !traits_of(scene.type).is_float);
    TESSERA_TRY_ASSIGN(const Judge judge, Judge::make(options));
    for (const Carrier& carrier : carriers)
        for (const double quality : carrier.qualities) {
            TESSERA_TRY(check_interrupt());
            Progress progress("tessera rd: " + carrier.name, options.quiet);
            TESSERA_TRY_ASSIGN(auto row,
                               measure(carrier, quality, options, judge, progress.function()));
            if (!options.quiet)
                print_line(row);
            report.rows.push_back(std::move(row));
            TESSERA_TRY(write_reports(options, report)); // keeps these rows if the next one fails
        }
    return report;
}

Json to_json(const ViewsReport& report) {
    Json rows = Json::array();
    for (const ViewsRow& r : report.rows)
        rows.push_back({{"carrier", r.carrier},
                        {"setting", r.setting},
                        {"texture", r.size},
                        {"raw_bytes", r.raw_bytes},
                        {"bytes", r.bytes},
                        {"paper", {{"psnr", r.paper.psnr}, {"ssim", r.paper.ssim}}},
                        {"around", {{"psnr", r.spread.psnr}, {"ssim", r.spread.ssim}}},
                        {"seconds", r.seconds}});
    return {{"scene", report.scene}, {"command", report.command}, {"rows", rows}};
}

std::string to_text(const ViewsReport& report) {
    std::string text =
        "# " + report.scene + ": quality of rendered views\n\n`" + report.command +
        "` compares rendered views with a direct ray trace of 16 rays per pixel.\nBytes are those "
        "of the whole file. *Paper*: the paper's five views, 640x480; *around*: 32 cameras on all\n"
        "sides at distances 6 to 30, 320x240. *surface:D SxT*: the objects' own surfaces, D texels "
        "per unit;\n*layers:D SxT*: D texels of colour per unit, and fewer for what depends on the "
        "direction;\n*plain*: the same with one 2D texture; *sphere*: the paper's sphere.\n\n"
        "| carrier | setting | texture | raw | bytes | paper dB | SSIM | around dB | SSIM |\n"
        "|---|---|---|---|---|---|---|---|---|\n";
    for (const ViewsRow& r : report.rows)
        text += "| " + r.carrier + " | " + r.setting + " | " + r.size + " | " +
                human_bytes(r.raw_bytes) + " | " + std::to_string(r.bytes) + " | " +
                format_number(r.paper.psnr, 2) + " | " + format_number(r.paper.ssim, 4) + " | " +
                format_number(r.spread.psnr, 2) + " | " + format_number(r.spread.ssim, 4) + " |\n";
    return text;
}

} // namespace tessera
