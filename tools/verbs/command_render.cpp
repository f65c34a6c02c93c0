#include "corpus/bake.h"
#include "format/output_file.h"
#include "tools/http/open_bytes.h"
#include "tools/support/fill_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/support/warnings.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/verbs/frame_log.h"
#include "tools/view/render_stage.h"
#include "tools/view/render_views.h"
#include "tools/view/view_file.h"
#include "tools/view/view_report.h"

#include <chrono>
#include <filesystem>

namespace tessera {
namespace {

struct RenderCommand {
    StageRequest stage;
    ViewRequest views;
    TextureArguments texture; // threads and quiet
    std::string sheet, pixel_filter;
    bool json = false, write_all = false, log = false, frames = false, strict = false;

    // Reading over a network is slow, so it shows what it does.
    bool logs() const { return !json && (log || (is_url(stage.file) && !texture.quiet)); }
};

Status check_outputs(const RenderCommand& a, const std::vector<PlannedView>& plan) {
    for (const PlannedView& view : plan) {
        TESSERA_TRY(check_view_path(view.output));
        for (const char* what : {"truth", "uncompressed"})
            if (a.write_all)
                TESSERA_TRY(check_view_path(beside(view.output, what)));
        if (a.frames)
            TESSERA_TRY(check_view_path(beside(view.output, "frame-1")));
    }
    if (a.sheet.empty())
        return {};
    if (to_path(a.sheet).extension() != ".png")
        return {ErrorCode::bad_argument, a.sheet + ": a sheet is a .png"};
    std::uint64_t pixels = 0;
    for (const PlannedView& view : plan) {
        pixels += 4ull * view.camera.width * view.camera.height;
        if (view.output == a.sheet)
            return {ErrorCode::bad_argument, a.sheet + ": is also the name of a view"};
    }
    if (pixels > max_sheet_pixels)
        return {ErrorCode::unsupported, a.sheet + ": the sheet would be too large"};
    return check_output_path(a.sheet);
}

// One progress bar for all views and all renderers. Each renderer reports the rows of its view.
class Steps {
public:
    Steps(ProgressFunction show, std::size_t count) : show_(std::move(show)), count_(count) {}
    ProgressFunction function() {
        if (!show_)
            return {};
        return [this](const char* stage, double done, double total) {
            show_(stage, static_cast<double>(begun_) - 1 + done / total,
                  static_cast<double>(count_));
        };
    }
    void set_count(std::size_t count) { count_ = count; }
    void begin() { ++begun_; }

private:
    ProgressFunction show_;
    std::size_t count_, begun_ = 0;
};

struct DrawnView {
    ViewPictures pictures; // kept for the sheet only
    ViewFigures figures;
    double seconds = 0; // for drawing the picture that is written
    std::string remark;
    std::vector<DrawnFrame> frames; // with --via feedback
    Traffic traffic;                // for the picture that is written
};

// Draws a view with every renderer of the stage. Writes that of the subject, and on request the
// others.
Result<DrawnView> draw(const PlannedView& planned, const Stage& stage, bool write_all,
                       Steps& steps) {
    DrawnView drawn;
    drawn.pictures.name = planned.name;
    const SampleType type = stage.desc.type;
    const auto add = [&](ViewRenderer* renderer, std::optional<Picture>& picture,
                         const char* what) -> Status {
        if (!renderer)
            return {};
        steps.begin();
        const auto start = std::chrono::steady_clock::now();
        TESSERA_TRY_ASSIGN(const auto view, renderer->render(planned.camera));
        picture = to_picture(view, type);
        if (renderer != &stage.subject())
            return write_all ? write_view(beside(planned.output, what), view, type) : Status();
        drawn.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        drawn.remark = view.remark;
        return write_view(planned.output, view, type);
    };
    TESSERA_TRY(add(stage.compressed.get(), drawn.pictures.compressed, "compressed"));
    TESSERA_TRY(add(stage.uncompressed.get(), drawn.pictures.uncompressed, "uncompressed"));
    TESSERA_TRY(add(stage.truth.get(), drawn.pictures.truth, "truth"));
    drawn.figures = measure(drawn.pictures);
    return drawn;
}

Status write_sheet(const std::string& path, const std::vector<DrawnView>& views) {
    std::vector<PanelRow> rows;
    for (const DrawnView& view : views)
        rows.push_back(to_panels(view.pictures));
    TESSERA_TRY_ASSIGN(const auto sheet, lay_out(rows).with_context(path));
    return write_png(path, sheet);
}

Json to_json(const glm::dvec3& point) {
    return {point.x, point.y, point.z};
}

Json to_json(const Traffic& traffic) {
    return {{"requests", traffic.requests}, {"bytes", traffic.bytes}};
}

Json to_json(const DrawnFrame& frame) {
    Json json = {{"touched", frame.touched}, {"decoded", frame.decoded}, {"coarse", frame.coarse}};
    json.update(to_json(frame.traffic));
    if (!frame.trouble.empty())
        json["trouble"] = frame.trouble;
    return json;
}

void report_json(const RenderCommand& a, const Stage& stage, const std::vector<PlannedView>& plan,
                 const std::vector<DrawnView>& views, const Warnings& warnings) {
    Json json = {{"size", to_string(stage.desc.size)}, {"via", a.stage.via}};
    if (a.stage.file.empty())
        json["scene"] = a.stage.scene;
    else
        json["file"] = a.stage.file;
    if (!a.stage.truth.empty())
        json["truth"] = a.stage.truth;
    if (const auto use = stage.subject().device_use())
        json["device"] = {{"name", use->name}, {"bytes", use->bytes}};
    if (stage.decoder && (a.stage.decode.allow_partial || a.stage.decode.allow_damaged))
        json["filled"] = fill_json(*stage.decoder);
    for (std::size_t i = 0; i < views.size(); ++i) {
        Json view = {{"name", plan[i].name},
                     {"output", plan[i].output},
                     {"eye", to_json(plan[i].camera.eye)},
                     {"forward", to_json(plan[i].camera.forward)},
                     {"width", plan[i].camera.width},
                     {"height", plan[i].camera.height},
                     {"seconds", views[i].seconds}};
        if (!views[i].remark.empty())
            view["remark"] = views[i].remark;
        if (!a.stage.file.empty())
            view.update(to_json(views[i].traffic));
        for (const DrawnFrame& frame : views[i].frames)
            view["frames"].push_back(to_json(frame));
        view.update(to_json(views[i].figures));
        json["views"].push_back(view);
    }
    json["warnings"] = warnings.json();
    print_json(json);
}

void report_text(const Stage& stage, const std::vector<PlannedView>& plan,
                 const std::vector<DrawnView>& views) {
    std::vector<ViewFigures> figures;
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::printf("%s: %u x %u pixels in %.2f s\n", plan[i].output.c_str(), plan[i].camera.width,
                    plan[i].camera.height, views[i].seconds);
        figures.push_back(views[i].figures);
    }
    if (!figures.front().empty())
        std::printf("\n%s", to_table(figures).c_str());
    if (stage.decoder)
        std::fputs(fill_text(*stage.decoder, "").c_str(), stdout);
    if (const auto use = stage.subject().device_use())
        std::printf("%s: %.1f MiB held\n", use->name.c_str(),
                    static_cast<double>(use->bytes) / (1 << 20));
}

// Remarks about incomplete pictures. They are not errors.
void report_remarks(const std::vector<PlannedView>& plan, const std::vector<DrawnView>& views) {
    for (std::size_t i = 0; i < views.size(); ++i)
        if (!views[i].remark.empty())
            std::fprintf(stderr, "tessera render: note: %s: %s\n", plan[i].output.c_str(),
                         views[i].remark.c_str());
}

// The GPU draws pinholes with their axis in the picture's centre, and one box a pixel.
Status check_device(const RenderCommand& a, const std::vector<PlannedView>& plan) {
    if (a.stage.via == "cpu")
        return {};
    if (!a.pixel_filter.empty())
        return {ErrorCode::unsupported, "--pixel-filter needs --via cpu"};
    for (const PlannedView& view : plan)
        if (view.camera.lens)
            return {ErrorCode::unsupported,
                    a.views.cameras + ": frame '" + view.name +
                        "': its lens distorts or is not centred, which needs --via cpu"};
    return {};
}

Result<std::vector<PlannedView>> plan_all(const RenderCommand& a, Warnings& warnings) {
    if (a.views.cameras.empty())
        return plan_views(a.views);
    std::vector<corpus::PhotographNote> notes;
    TESSERA_TRY_ASSIGN(auto plan, plan_photographs(a.views, notes));
    for (const corpus::PhotographNote& note : notes)
        TESSERA_TRY(warnings.add(note.kind, note.place, note.count));
    return plan;
}

Status run(const RenderCommand& a) {
    Warnings warnings(a.strict);
    TESSERA_TRY_ASSIGN(auto plan, plan_all(a, warnings));
    TESSERA_TRY(check_outputs(a, plan));
    TESSERA_TRY(check_device(a, plan));
    if (!a.views.camera.empty() && a.stage.file.empty())
        return {ErrorCode::bad_argument, "--camera needs a .tess file that was baked from a model"};
    if (a.frames && a.stage.via != "feedback")
        return {ErrorCode::bad_argument, "--frames belongs to --via feedback"};
    Stage stage;
    std::vector<DrawnView> views;
    {
        Progress progress("tessera render", a.texture.quiet);
        Steps steps(progress.function(), 1);
        RenderOptions options{a.texture.threads, std::uint64_t{a.stage.budget_mib} << 20,
                              steps.function()};
        if (!a.pixel_filter.empty()) {
            TESSERA_TRY_ASSIGN(
                options.filter,
                corpus::PixelFilter::parse(a.pixel_filter).with_context("--pixel-filter"));
        }
        TESSERA_TRY_ASSIGN(stage, set_up_stage(a.stage, options));
        if (!a.views.camera.empty()) {
            TESSERA_TRY_ASSIGN(plan, plan_camera(a.views, stage.decoder->container().metadata())
                                         .with_context(a.stage.file));
        }
        if (a.views.cameras.empty() && a.views.camera.empty() && !stage.planar) {
            ViewRequest views = a.views;
            views.frame = stage.frame;
            TESSERA_TRY_ASSIGN(plan, plan_views(views));
        }
        if (stage.planar && a.views.camera.empty() && a.views.cameras.empty()) {
            TESSERA_TRY_ASSIGN(plan, plan_views(a.views, stage.planar->cameras, stage.desc.size));
        }
        if (!a.views.cameras.empty())
            for (PlannedView& view : plan)
                view.camera = stage.in_texture(view.camera);
        steps.set_count(plan.size() * stage.renderers());
        if (stage.window)
            for (const PlannedView& view : plan)
                TESSERA_TRY(check_side(*stage.window, view.camera).with_context(view.name));
        FrameLog log(a.logs(), a.frames, is_url(a.stage.file), stage.desc.type);
        stage.subject().watch(
            [&log](unsigned number, const DrawnFrame& frame, const auto& picture) {
                return log.add(number, frame, picture);
            });
        Traffic before; // none, so that the first view includes opening the file
        for (const PlannedView& view : plan) {
            TESSERA_TRY(check_interrupt());
            log.begin(views.size() + 1, view.output);
            TESSERA_TRY_ASSIGN(auto drawn, draw(view, stage, a.write_all, steps));
            drawn.traffic = stage.traffic() - before;
            before = stage.traffic();
            drawn.frames = log.end(drawn.traffic);
            if (a.sheet.empty())
                drawn.pictures = {};
            views.push_back(std::move(drawn));
        }
    }
    warnings.print("render");
    report_remarks(plan, views);
    if (!a.sheet.empty())
        TESSERA_TRY(write_sheet(a.sheet, views));
    if (a.json)
        report_json(a, stage, plan, views, warnings);
    else if (!a.texture.quiet)
        report_text(stage, plan, views);
    return {};
}

void declare_camera(CLI::App& c, RenderCommand& a) {
    ViewRequest& r = a.views;
    OptionGroup group(c, "Camera");
    auto* eye =
        group.option("--eye", "X,Y,Z", r.eye,
                     "Position of the observer. Default: 10,0,0; meshes of other sizes: as far "
                     "from them; planar views: amid the cameras");
    auto* look =
        group.option("--look", "X,Y,Z", r.look,
                     "A point straight ahead. Default: 0,0,0; other meshes: their middle; planar "
                     "views: fill the picture");
    auto* fov = group.option("--fov", "DEGREES", r.fov, "Vertical field of view. Default: 45");
    auto* pixels = group.option("--pixels", "WxH", r.size, "Size of the picture. Default: 640x480");
    auto* views =
        group
            .option("--views", "paper or 1..5", r.views,
                    "The five standard views of the surface, as name-1.png and so on, or one of "
                    "them")
            ->excludes(eye)
            ->excludes(look);
    auto* orbit = group
                      .option("--orbit", "N", r.orbit,
                              "Numbered frames around the vertical line through --look",
                              CLI::Range(1u, 100000u))
                      ->excludes(views);
    auto* camera = group.option("--camera", "NAME", r.camera,
                                "A camera of the glTF file that was baked; info lists them");
    for (CLI::Option* other : {eye, look, fov, views, orbit})
        camera->excludes(other);
    auto* cameras =
        group.option("--cameras", "FILE or FOLDER", r.cameras,
                     "The cameras of photographs: a transforms.json of NeRF or nerfstudio, or a "
                     "COLMAP model. The pictures get the photographs' names and sizes");
    for (CLI::Option* other : {eye, look, fov, pixels, views, orbit, camera})
        cameras->excludes(other);
    group
        .option("--scale", "FACTOR", r.scale, "The pictures' size relative to the photographs'",
                number_between(1e-3, 1000))
        ->needs(cameras);
    group.option("--focus", "LENGTH", a.stage.focus,
                 "Distance where planar views are superimposed. Default: where they coincide");
}

void declare_renderer(CLI::App& c, RenderCommand& a) {
    StageRequest& r = a.stage;
    OptionGroup group(c, "Renderer");
    group.option("--via", "NAME", r.via,
                 "cpu (default), or on the GPU: load (decoded as a whole), feedback (a cache of "
                 "visible tiles), gpu (load if the budget suffices, else feedback)",
                 one_of({"cpu", "gpu", "load", "feedback"}));
    group
        .option("--budget", "SIZE", r.budget_mib,
                "Memory for decoded texels; on the GPU, for all of the file. Default: 512M")
        ->transform(size_in_mebibytes());
    group.option(
        "--rays", "N", r.rays,
        "Per pixel, on the CPU. Default: 1 for a sphere, 4 for a mesh. Details smaller than a "
        "pixel need more, in --truth, too",
        CLI::Range(1u, 65536u));
    group.option(
        "--pixel-filter", "NAME[:WIDTH]", a.pixel_filter,
        "box (default, 1 pixel wide), gauss (4.5) or blackman-harris (3), as Blender has them; "
        "give more --rays");
    group.option("--tiles-per-frame", "N", r.tiles_per_frame,
                 "feedback: most tiles to decode between two frames, so that a view sharpens in "
                 "steps. Default: all",
                 CLI::Range(0u, 1u << 24));
    group.flag("--frames", a.frames,
               "feedback: also write the unfinished frames, as name-frame-1.png and so on");
    group.flag("--log", a.log,
               "Print what each frame touched, decoded, lacked and read. Default for URLs");
}

void declare_comparison(CLI::App& c, RenderCommand& a) {
    StageRequest& r = a.stage;
    OptionGroup group(c, "Comparison");
    auto* truth = group.option("--truth", "SCENE or FILE", r.truth,
                               "Measure against a ray-traced scene or model; on a sphere, also "
                               "against the uncompressed texture");
    group
        .option("--truth-spp", "N", r.truth_samples,
                "Rays per pixel for it. Default: 16, or 512 paths for a model",
                CLI::Range(1u, 65536u))
        ->needs(truth);
    group
        .option("--env", "FILE", r.truth_environment,
                "Environment light of the model, if the file has moved since bake")
        ->needs(truth);
    group.option("--original", "FILE", r.original,
                 "The uncompressed texture (raw or .tess). Default: baked where visible");
    group.option("--spp", "N", r.samples,
                 "Rays per texel for baking. Default: as the file says, else 16",
                 CLI::Range(1u, corpus::max_samples_per_texel));
    group.flag("--write-all", a.write_all, "Also write name-truth.png and name-uncompressed.png");
    group.option("--sheet", "FILE", a.sheet, "Write one .png with all views and their differences");
}

void declare(CLI::App& c, RenderCommand& a) {
    StageRequest& r = a.stage;
    c.add_option("file", r.file,
                 "A .tess with a texture on a sphere or a mesh, or planar views; or its URL");
    c.add_option("-o,--output", a.views.output,
                 "The .png (8-bit; HDR as sRGB of x / (1 + x)) or .exr (linear) to write; with "
                 "--cameras, "
                 "also a folder")
        ->required();
    c.add_option("--scene", r.scene,
                 "Instead of a file: a built-in scene, baked where it is visible")
        ->option_text("NAME");
    c.add_option("--size", r.texture_size, "Size of that texture. Default: see bake --list")
        ->option_text("UxVxSxT");
    add_fill_options(c, r.decode);
    c.add_flag("--json", a.json, "Print JSON");
    c.add_flag("--strict", a.strict, "Make warnings about the photographs of --cameras errors");
    add_threads_options(c, a.texture);
    declare_camera(c, a);
    declare_renderer(c, a);
    declare_comparison(c, a);
    add_network_options(c);
}

} // namespace

void add_render_command(CLI::App& app, Invocation& chosen) {
    add_verb<RenderCommand>(
        app, chosen, "render", "Draw what an observer sees of the textured surface",
        "PSNR and SSIM refer to the whole 8-bit picture as displayed. Times include reading and "
        "decoding, but only of the picture that is written. With --via feedback the first frame "
        "shows coarse data at once (for files encoded with --layers, after a few kilobytes).\n\n"
        "Examples:\n"
        "  tessera render scene.tess -o view.png --eye 8,3,-6\n"
        "  tessera render scene.tess -o v.png --views paper --truth composed --sheet sheet.png\n"
        "  tessera render bunny.tess -o v.png --views paper --truth bunny.glb\n"
        "  tessera render room.tess -o v.png --camera Camera.001\n"
        "  tessera render scene.tess -o frame.png --orbit 120 --pixels 1280x720 --via feedback\n"
        "  tessera render suzi.tess -o drawn/ --cameras suzi/transforms_test.json\n"
        "  tessera render http://host/scene.tess -o v.png --via feedback --frames\n"
        "  tessera render --scene composed --size 1024x512x128x128 -o v.png --views 1",
        declare, run);
}

} // namespace tessera
