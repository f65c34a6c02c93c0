#include "codec/decoder.h"
#include "corpus/bake.h"
#include "format/sampler.h"
#include "tools/command.h"
#include "tools/gpu_renderer.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tools/render_views.h"
#include "tools/texture_arguments.h"
#include "tools/texture_io.h"
#include "tools/view_file.h"
#include "tools/view_report.h"

#include <chrono>
#include <filesystem>

namespace tessera {
namespace {

// Small along s and t: an observer sees each place from one direction.
constexpr Extent4 lazy_block{8, 8, 4, 4};

struct Arguments {
    std::string file, via = "cpu", truth, original, sheet;
    ViewRequest request;
    TextureArguments texture; // threads and quiet
    unsigned budget_mib = 512, truth_samples = 16;
    std::optional<unsigned> samples;
    bool json = false;
};

// The compressed file and what else is drawn. Members are destroyed last to first: renderers before
// what they read.
struct Stage {
    std::unique_ptr<ByteSource> bytes;
    std::unique_ptr<Decoder> decoder;
    std::unique_ptr<TexelSource> texels, original;
    std::unique_ptr<ViewRenderer> compressed, uncompressed, truth; // the last two may be absent

    const TextureDesc& desc() const { return decoder->desc(); }
    const Description& description() const { return decoder->container().description(); }
    const Metadata& metadata() const { return decoder->container().metadata(); }
    unsigned renderers() const { return 1 + (uncompressed ? 1 : 0) + (truth ? 1 : 0); }
};

glm::dvec3 background_of(const FileHeader& header) {
    std::byte texel[8];
    for (std::size_t c = 0; c < 4; ++c) {
        const std::uint16_t sample = header.background[c];
        if (header.desc.type == SampleType::unorm8) {
            texel[c] = std::byte(sample);
        } else {
            texel[2 * c] = std::byte(sample & 255);
            texel[2 * c + 1] = std::byte(sample >> 8);
        }
    }
    const glm::dvec4 value = texel_value(header.desc, texel);
    return header.desc.channels >= 3 ? glm::dvec3(value) : glm::dvec3(value.x);
}

// The number that the file remembers under `key` from when it was baked.
std::optional<std::uint64_t> remembered(const Metadata& metadata, const std::string& key) {
    const auto entry = metadata.find(key);
    std::uint64_t number = 0;
    if (entry == metadata.end() || !parse_number(entry->second, number))
        return std::nullopt;
    return number;
}

Result<std::unique_ptr<TexelSource>> open_original(const Arguments& a, const Stage& stage) {
    const TextureKind kind = kind_of(a.original);
    if (kind != TextureKind::raw && kind != TextureKind::tess)
        return Status(ErrorCode::bad_argument,
                      a.original + ": --original takes a raw file or a .tess, whose texels can be "
                                   "read in any order");
    TextureHints hints;
    hints.size = stage.desc().size;
    hints.type = stage.desc().type;
    hints.channels = stage.desc().channels;
    auto opened = open_texture(a.original, hints);
    if (!opened.ok())
        return opened.status();
    if (opened->source->desc() != stage.desc())
        return Status(ErrorCode::bad_argument,
                      a.original + ": its samples are not of the type or number of those of " +
                          a.file);
    return std::move(opened->source);
}

// The texture before compression, baked where it is looked at.
Result<std::unique_ptr<TexelSource>> bake_original(const Arguments& a, const Stage& stage) {
    const std::uint64_t samples =
        a.samples ? *a.samples : remembered(stage.metadata(), "Samples per texel").value_or(16);
    if (samples > corpus::max_samples_per_texel)
        return Status(ErrorCode::bad_argument,
                      a.file + ": says it has " + std::to_string(samples) +
                          " samples per texel, too many; --spp says another number");
    auto baked =
        corpus::make_baked_source(a.truth, stage.desc().size, static_cast<unsigned>(samples),
                                  remembered(stage.metadata(), "Seed").value_or(1));
    if (baked.ok() && (*baked)->desc() != stage.desc())
        return Status(ErrorCode::bad_argument, a.file + ": its samples are not of the type or " +
                                                   "number of those of the scene " + a.truth);
    return baked;
}

Status add_truth(const Arguments& a, const SphereWindow& window, const RenderOptions& options,
                 Stage& stage) {
    auto scene = corpus::make_scene(a.truth);
    if (!scene.ok())
        return scene.status().with_context("--truth");
    const auto said = stage.metadata().find("Scene");
    if (said != stage.metadata().end() && said->second != a.truth)
        return {ErrorCode::bad_argument,
                a.file + ": is of the scene " + said->second + ", not " + a.truth};
    if (scene->type != stage.desc().type)
        return {ErrorCode::bad_argument, a.file + ": is " + name_of(stage.desc().type) +
                                             ", and the scene " + a.truth + " is " +
                                             name_of(scene->type)};
    stage.truth = make_truth_renderer(std::move(*scene), window, a.truth_samples, options);
    return {};
}

Status set_up(const Arguments& a, const RenderOptions& options, Stage& stage) {
    if (kind_of(a.file) != TextureKind::tess)
        return {ErrorCode::bad_argument, a.file + ": render draws .tess files"};
    auto bytes = open_file(a.file);
    if (!bytes.ok())
        return bytes.status();
    stage.bytes = std::move(*bytes);
    auto decoder = Decoder::open(*stage.bytes);
    if (!decoder.ok())
        return decoder.status();
    stage.decoder = std::make_unique<Decoder>(std::move(*decoder));
    const auto window = sphere_window(stage.description());
    if (!window.ok())
        return window.status().with_context(a.file);
    const FileHeader& header = stage.decoder->container().header();
    const glm::dvec3 background = background_of(header);
    if (a.via == "cpu") {
        stage.texels = decoded_source(*stage.decoder);
        stage.compressed =
            make_texture_renderer(*stage.texels, stage.decoder->container().grid().tile_extent(),
                                  *window, background, options);
    } else {
        auto gpu = make_gpu_renderer(a.file, a.via, a.budget_mib);
        if (!gpu.ok())
            return gpu.status();
        stage.compressed = std::move(*gpu);
    }
    if (!a.truth.empty())
        TESSERA_TRY(add_truth(a, *window, options, stage));
    if (a.truth.empty() && a.original.empty())
        return {};
    auto original = a.original.empty() ? bake_original(a, stage) : open_original(a, stage);
    if (!original.ok())
        return original.status();
    stage.original = std::move(*original);
    stage.uncompressed =
        make_texture_renderer(*stage.original, lazy_block, *window, background, options);
    return {};
}

Status check_outputs(const Arguments& a, const std::vector<PlannedView>& plan) {
    for (const PlannedView& view : plan)
        TESSERA_TRY(check_view_path(view.output));
    if (a.sheet.empty())
        return {};
    if (std::filesystem::path(a.sheet).extension() != ".png")
        return {ErrorCode::bad_argument, a.sheet + ": a sheet is a .png"};
    std::uint64_t pixels = 0;
    for (const PlannedView& view : plan) {
        pixels += 4ull * view.camera.width * view.camera.height;
        if (view.output == a.sheet)
            return {ErrorCode::bad_argument, a.sheet + ": is a view's name, too"};
    }
    if (pixels > max_sheet_pixels)
        return {ErrorCode::unsupported, a.sheet + ": the sheet would be too large"};
    return check_output_path(a.sheet);
}

// One bar for all views and all renderers; each renderer reports the rows of its view.
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
    double seconds = 0; // of drawing the compressed file
};

Result<DrawnView> draw(const PlannedView& planned, const Stage& stage, Steps& steps) {
    DrawnView drawn;
    drawn.pictures.name = planned.name;
    const SampleType type = stage.desc().type;
    steps.begin();
    const auto start = std::chrono::steady_clock::now();
    const auto view = stage.compressed->render(planned.camera);
    if (!view.ok())
        return view.status();
    drawn.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    TESSERA_TRY(write_view(planned.output, *view, type));
    drawn.pictures.compressed = to_picture(*view, type);
    const auto add = [&](ViewRenderer* renderer, std::optional<Picture>& picture) -> Status {
        if (!renderer)
            return {};
        steps.begin();
        const auto other = renderer->render(planned.camera);
        if (other.ok())
            picture = to_picture(*other, type);
        return other.status();
    };
    TESSERA_TRY(add(stage.uncompressed.get(), drawn.pictures.uncompressed));
    TESSERA_TRY(add(stage.truth.get(), drawn.pictures.truth));
    drawn.figures = measure(drawn.pictures);
    return drawn;
}

Status write_sheet(const std::string& path, const std::vector<DrawnView>& views) {
    std::vector<PanelRow> rows;
    for (const DrawnView& view : views)
        rows.push_back(to_panels(view.pictures));
    const auto sheet = lay_out(rows);
    if (!sheet.ok())
        return sheet.status().with_context(path);
    return write_png(path, *sheet);
}

Json to_json(const glm::dvec3& point) {
    return {point.x, point.y, point.z};
}

void report_json(const Arguments& a, const Stage& stage, const std::vector<PlannedView>& plan,
                 const std::vector<DrawnView>& views) {
    Json json = {{"file", a.file}, {"size", to_string(stage.desc().size)}, {"via", a.via}};
    if (!a.truth.empty())
        json["truth"] = a.truth;
    for (std::size_t i = 0; i < views.size(); ++i) {
        Json view = {{"name", plan[i].name},
                     {"output", plan[i].output},
                     {"eye", to_json(plan[i].camera.eye)},
                     {"forward", to_json(plan[i].camera.forward)},
                     {"width", plan[i].camera.width},
                     {"height", plan[i].camera.height},
                     {"seconds", views[i].seconds}};
        view.update(to_json(views[i].figures));
        json["views"].push_back(view);
    }
    print_json(json);
}

void report_text(const std::vector<PlannedView>& plan, const std::vector<DrawnView>& views) {
    std::vector<ViewFigures> figures;
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::printf("%s: %u x %u pixels in %.2f s\n", plan[i].output.c_str(), plan[i].camera.width,
                    plan[i].camera.height, views[i].seconds);
        figures.push_back(views[i].figures);
    }
    if (!figures.front().empty())
        std::printf("\n%s", to_table(figures).c_str());
}

Status run(const Arguments& a) {
    const auto plan = plan_views(a.request);
    if (!plan.ok())
        return plan.status();
    TESSERA_TRY(check_outputs(a, *plan));
    Stage stage;
    std::vector<DrawnView> views;
    {
        Progress progress("tessera render", a.texture.quiet);
        Steps steps(progress.function(), 1);
        const RenderOptions options{a.texture.threads, std::uint64_t{a.budget_mib} << 20,
                                    steps.function()};
        TESSERA_TRY(set_up(a, options, stage));
        steps.set_count(plan->size() * stage.renderers());
        const auto window = sphere_window(stage.description());
        for (const PlannedView& view : *plan)
            TESSERA_TRY(check_outside(*window, view.camera).with_context(view.name));
        for (const PlannedView& view : *plan) {
            if (interrupted_by())
                return {ErrorCode::runtime, "interrupted"};
            auto drawn = draw(view, stage, steps);
            if (!drawn.ok())
                return drawn.status();
            if (a.sheet.empty())
                drawn->pictures = {};
            views.push_back(std::move(*drawn));
        }
    }
    if (!a.sheet.empty())
        TESSERA_TRY(write_sheet(a.sheet, views));
    if (a.json)
        report_json(a, stage, *plan, views);
    else if (!a.texture.quiet)
        report_text(*plan, views);
    return {};
}

void declare_camera(CLI::App& c, ViewRequest& r) {
    auto* eye = c.add_option("--eye", r.eye, "Where the observer stands, x,y,z (10,0,0)");
    auto* look = c.add_option("--look", r.look, "A point straight ahead, x,y,z (0,0,0)");
    c.add_option("--fov", r.fov, "Vertical field of view in degrees")->capture_default_str();
    c.add_option("--size", r.size, "Pixels of the picture, WxH (640x480)");
    auto* views =
        c.add_option("--views", r.views,
                     "paper: the paper's five views, numbered name-1.png and so on; 1..5: one of "
                     "them")
            ->excludes(eye)
            ->excludes(look);
    c.add_option("--orbit", r.orbit,
                 "So many frames once around the vertical line through the look point, numbered")
        ->check(CLI::Range(1u, 100000u))
        ->excludes(views);
}

} // namespace

void add_render_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, Arguments& a) {
        c.add_option("file", a.file, "A .tess with a texture on a sphere")->required();
        c.add_option("-o,--output", a.request.output,
                     "The .png (8-bit; HDR as sRGB of x / (1 + x)) or .exr to write")
            ->required();
        declare_camera(c, a.request);
        c.add_option("--via", a.via,
                     "How texels get into the picture: cpu, or on the GPU load, feedback, sample")
            ->check(CLI::IsMember({"cpu", "load", "feedback", "sample"}))
            ->capture_default_str();
        c.add_option("--budget", a.budget_mib, "MiB of decoded texels kept in memory")
            ->check(CLI::Range(1u, 1u << 20))
            ->capture_default_str();
        auto* truth = c.add_option("--truth", a.truth,
                                   "A built-in scene to ray trace and measure against, together "
                                   "with the uncompressed texture");
        c.add_option("--truth-spp", a.truth_samples, "Rays per pixel of the truth")
            ->check(CLI::Range(1u, 65536u))
            ->capture_default_str()
            ->needs(truth);
        auto* original = c.add_option("--original", a.original,
                                      "The uncompressed texture (raw or .tess); without it, it is "
                                      "baked where it is looked at");
        c.add_option("--spp", a.samples,
                     "Samples per texel of that baking (default: what the file says, or 16)")
            ->check(CLI::Range(1u, corpus::max_samples_per_texel))
            ->needs(truth)
            ->excludes(original);
        c.add_option("--sheet", a.sheet, "One .png with all views, and the differences");
        c.add_flag("--json", a.json, "Print JSON");
        add_threads_options(c, a.texture);
    };
    add_verb<Arguments>(
        app, chosen, "render", "Draw what an observer sees of the sphere",
        "PSNR and SSIM are of the whole 8-bit picture as displayed. Seconds are those of reading,\n"
        "decoding and sampling the compressed file only.\n\n"
        "Examples:\n"
        "  tessera render scene.tess -o view.png --eye 8,3,-6\n"
        "  tessera render scene.tess -o v.png --views paper --truth composed --sheet sheet.png\n"
        "  tessera render scene.tess -o frame.png --orbit 120 --size 1280x720",
        declare, run);
}

} // namespace tessera
