#include "tools/view/gpu_renderer.h"

#ifdef TESSERA_GPU
#include "decoder_glsl/gl_context.h"
#include "tools/support/interrupt.h"
#include "tools/view/gpu_camera.h"

#include <algorithm>
#include <optional>
#include <utility>
#endif

namespace tessera {
namespace {

// Adds the advice to draw on the CPU if the GPU cannot draw this file.
Status or_by_cpu(const Status& status, const std::string& via) {
    if (status.code() != ErrorCode::unsupported)
        return status;
    return Status(ErrorCode::unsupported, status.message() + " (--via cpu always works)")
        .with_context("--via " + via);
}

} // namespace

#ifdef TESSERA_GPU
namespace {

// A still view needs two frames: one marks its tiles, the next one has them. More are needed where
// decoding is spread over several frames.
constexpr unsigned most_frames = 8;

// Drawing fails after this many consecutive frames with read errors. The source has already retried
// each read several times.
constexpr unsigned most_troubled = 3;

class GpuRenderer final : public ViewRenderer {
public:
    GpuRenderer(HeadlessContext context, const glm::dvec3& background,
                const GpuRenderOptions& options)
        : context_(std::move(context)), background_(background), options_(options) {}
    GpuRenderer(const GpuRenderer&) = delete;
    GpuRenderer& operator=(const GpuRenderer&) = delete;
    ~GpuRenderer() override {
        // These own objects of the context, so they must be destroyed while it is current.
        if (context_.make_current()) {
            view_.reset();
            textures_.clear();
        }
    }

    Status open(const ContainerReader& reader, const SphereWindow& window) {
        TESSERA_TRY(open_texture(reader));
        window_ = window;
        TESSERA_TRY_ASSIGN(auto view, GlViewRenderer::create(textures_[0]));
        view_.emplace(std::move(view));
        return {};
    }

    Status open(const ContainerReader& reader, const SurfaceMesh& mesh) {
        TESSERA_TRY(open_texture(reader));
        TESSERA_TRY_ASSIGN(auto view, GlViewRenderer::create(textures_[0], mesh));
        view_.emplace(std::move(view));
        return {};
    }

    Status open(std::span<const GpuLayer> layers, std::span<const DistantLight> lights,
                const SurfaceMesh& mesh) {
        const Residency residency = residency_for(needed_on_load(layers) <= budget());
        if (residency == Residency::on_load)
            TESSERA_TRY(check_budget(layers));
        std::vector<SampledTextureRequest> files;
        for (const GpuLayer& layer : layers) {
            files.push_back({layer.reader, options_of(*layer.reader, residency, layer.coarse)});
            files.back().options.mesh = &mesh;
        }
        TESSERA_TRY(create_textures(files));
        std::vector<ViewLayer> drawn;
        for (std::size_t i = 0; i < layers.size(); ++i)
            drawn.push_back({layers[i].role, layers[i].scale,
                             layers[i].reader->description().transfer, &textures_[i]});
        TESSERA_TRY_ASSIGN(auto view, GlViewRenderer::create(drawn, lights, mesh));
        view_.emplace(std::move(view));
        return {};
    }

    Result<View> render(const Camera& camera) override {
        if (window_)
            TESSERA_TRY(check_side(*window_, camera));
        TESSERA_TRY(context_.make_current());
        TESSERA_TRY_ASSIGN(const auto report,
                           draw(gpu_camera(camera, window_.value_or(SphereWindow{}), background_)));
        for (std::size_t i = 0; i < textures_.size(); ++i)
            if (const std::uint64_t damaged = textures_[i].damaged_tiles(); damaged > 0)
                return Status(ErrorCode::invalid_file,
                              names_[i] + ": " + std::to_string(damaged) +
                                  " tiles are damaged; tessera validate lists them");
        auto view = read_view(camera.width, camera.height);
        if (view.ok())
            view->remark = remark_on(report);
        return view;
    }

    void watch(FrameHook hook) override { hook_ = std::move(hook); }

    std::optional<DeviceUse> device_use() const override {
        return DeviceUse{context_.device(), texture_bytes() + view_->bytes()};
    }

private:
    Residency residency_for(bool fits) const {
        const bool whole = options_.via == "gpu" ? fits : options_.via == "load";
        return whole ? Residency::on_load : Residency::on_feedback;
    }

    SampledTextureOptions options_of(const ContainerReader& reader, Residency residency,
                                     const CoarseLevel& coarse) const {
        SampledTextureOptions options;
        options.residency = residency;
        options.jobs_per_update = options_.tiles_per_frame;
        options.coarse_from = {coarse.level, coarse.texels};
        // Without a coarse level, the coarse texels are the means of all tiles, and a partial file
        // does not have all of them.
        options.coarse = coarse.texels != nullptr || !reader.is_partial();
        return options;
    }

    Status create_textures(std::span<const SampledTextureRequest> files) {
        TESSERA_TRY_ASSIGN(textures_, SampledTexture::create(files, budget()));
        for (const SampledTextureRequest& file : files)
            names_.push_back(file.reader->name());
        by_frames_ = files[0].options.residency == Residency::on_feedback;
        return {};
    }

    Status open_texture(const ContainerReader& reader) {
        const bool fits = choose_residency(reader, budget()) == Residency::on_load;
        const SampledTextureRequest file{&reader,
                                         options_of(reader, residency_for(fits), options_.coarse)};
        return create_textures(std::span(&file, 1));
    }

    static std::uint64_t needed_on_load(std::span<const GpuLayer> layers) {
        std::uint64_t needed = 32ull << 20; // for decoding
        for (const GpuLayer& layer : layers)
            needed += decoded_bytes(*layer.reader);
        return needed;
    }

    Status check_budget(std::span<const GpuLayer> layers) const {
        constexpr std::uint64_t mebibyte = 1 << 20;
        const std::uint64_t needed = needed_on_load(layers);
        if (needed <= budget())
            return {};
        return {ErrorCode::unsupported, layers[0].reader->name() +
                                            ": all texels of its layers need --budget " +
                                            std::to_string((needed + mebibyte - 1) / mebibyte) +
                                            "M; --via feedback decodes only tiles in view"};
    }

    std::uint64_t budget() const { return std::uint64_t{options_.budget_mib} << 20; }

    std::uint64_t texture_bytes() const {
        std::uint64_t bytes = 0;
        for (const SampledTexture& each : textures_)
            bytes += each.bytes();
        return bytes;
    }

    Result<View> read_view(std::uint32_t width, std::uint32_t height) const {
        TESSERA_TRY_ASSIGN(const auto pixels, view_->read());
        View view{width, height, {}};
        view.rgb.reserve(pixels.size() / 4 * 3);
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            view.rgb.insert(view.rgb.end(), {pixels[i], pixels[i + 1], pixels[i + 2]});
        return view;
    }

    // Draws frames until another frame would not make the picture sharper.
    Result<UpdateReport> draw(const ViewCamera& camera) {
        UpdateReport report;
        unsigned troubled = 0;
        for (unsigned frame = 1;; ++frame) {
            TESSERA_TRY(check_interrupt());
            TESSERA_TRY(view_->draw(camera));
            const Traffic before = traffic(); // update() reads for the next frame
            const UpdateReport last = std::exchange(report, {});
            TESSERA_TRY_ASSIGN(report, update_textures());
            TESSERA_TRY(tell(camera, frame, report, last, before));
            if (!report.trouble.ok()) {
                if (report.trouble.code() != ErrorCode::io || ++troubled == most_troubled)
                    return report.trouble;
                continue;
            }
            troubled = 0;
            if (report.decoded == 0 || frame >= most_frames + spread_over(report))
                return report;
        }
    }

    // The sum of the reports of all textures.
    Result<UpdateReport> update_textures() {
        UpdateReport sum;
        sum.current = true;
        needed_budget_ = 0;
        for (SampledTexture& texture : textures_) {
            TESSERA_TRY_ASSIGN(const UpdateReport own, texture.update(true));
            sum.touched += own.touched;
            sum.missing += own.missing;
            sum.decoded += own.decoded;
            sum.waiting += own.waiting;
            sum.current = sum.current && own.current;
            if (sum.trouble.ok())
                sum.trouble = own.trouble;
            needed_budget_ = std::max(needed_budget_, texture.budget_for(own.touched));
        }
        return sum;
    }

    unsigned spread_over(const UpdateReport& report) const {
        return options_.tiles_per_frame == 0 ? 0 : report.touched / options_.tiles_per_frame;
    }

    Traffic traffic() const { return options_.traffic ? options_.traffic() : Traffic{}; }

    // Reports a frame to the hook. `seen` is the update after drawing the frame, `last` the update
    // before it, and `now` the traffic at the time when the frame was drawn.
    Status tell(const ViewCamera& camera, unsigned number, const UpdateReport& seen,
                const UpdateReport& last, const Traffic& now) {
        if (!hook_ || !by_frames_)
            return {};
        const DrawnFrame frame{seen.touched, last.decoded, seen.missing, now - told_,
                               last.trouble.ok() ? "" : last.trouble.message()};
        told_ = now;
        return hook_(number, frame, [&] { return read_view(camera.width, camera.height); });
    }

    std::string remark_on(const UpdateReport& report) const {
        const std::uint32_t missing = report.waiting + report.decoded;
        if (missing == 0 && report.missing > 0)
            return std::to_string(report.missing) + " of the " + std::to_string(report.touched) +
                   " tiles in view have not been received and are drawn coarsely";
        if (missing == 0)
            return {};
        return std::to_string(missing) + " of the " + std::to_string(report.touched) +
               " tiles in view do not fit into --budget " + std::to_string(options_.budget_mib) +
               "M and are drawn coarsely; --budget " + std::to_string((needed_budget_ >> 20) + 1) +
               "M would hold all of them";
    }

    HeadlessContext context_;
    std::optional<SphereWindow> window_; // absent: a mesh
    glm::dvec3 background_;
    GpuRenderOptions options_;
    std::vector<SampledTexture> textures_;
    std::vector<std::string> names_;  // of their files
    std::uint64_t needed_budget_ = 0; // with which the last frame would miss no tiles
    std::optional<GlViewRenderer> view_;
    bool by_frames_ = false;
    FrameHook hook_;
    Traffic told_; // reported to the hook so far
};

// `subject` is what one of the functions GpuRenderer::open() takes.
template <class... Subject>
Result<std::unique_ptr<ViewRenderer>> make_renderer(const glm::dvec3& background,
                                                    const GpuRenderOptions& options,
                                                    const Subject&... subject) {
    auto context = HeadlessContext::create();
    if (!context.ok())
        return or_by_cpu(context.status(), options.via);
    auto renderer = std::make_unique<GpuRenderer>(std::move(*context), background, options);
    const Status opened = renderer->open(subject...);
    if (!opened.ok())
        return or_by_cpu(opened, options.via);
    return std::unique_ptr<ViewRenderer>(std::move(renderer));
}

} // namespace
#else
namespace {

template <class... Subject>
Result<std::unique_ptr<ViewRenderer>>
make_renderer(const glm::dvec3&, const GpuRenderOptions& options, const Subject&...) {
    return or_by_cpu({ErrorCode::unsupported, "this build has no GPU support (TESSERA_GPU is off)"},
                     options.via);
}

} // namespace
#endif

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SphereWindow& window,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options) {
    return make_renderer(background, options, reader, window);
}

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options) {
    return make_renderer(background, options, reader, mesh);
}

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(std::span<const GpuLayer> layers,
                                                        std::span<const DistantLight> lights,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options) {
    return make_renderer(background, options, layers, lights, mesh);
}

} // namespace tessera
