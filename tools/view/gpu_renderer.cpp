#include "tools/view/gpu_renderer.h"

#ifdef TESSERA_GPU
#include "decoder_glsl/gl_context.h"
#include "tools/support/interrupt.h"
#include "tools/view/gpu_camera.h"

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
    GpuRenderer(HeadlessContext context, const ContainerReader& reader,
                const glm::dvec3& background, const GpuRenderOptions& options)
        : context_(std::move(context)), reader_(reader), background_(background),
          options_(options) {}
    GpuRenderer(const GpuRenderer&) = delete;
    GpuRenderer& operator=(const GpuRenderer&) = delete;
    ~GpuRenderer() override {
        // These own objects of the context, so they must be destroyed while it is current.
        if (context_.make_current()) {
            view_.reset();
            texture_.reset();
        }
    }

    Status open(const SphereWindow& window) {
        TESSERA_TRY(open_texture());
        window_ = window;
        TESSERA_TRY_ASSIGN(auto view, GlViewRenderer::create(*texture_));
        view_.emplace(std::move(view));
        return {};
    }

    Status open(const SurfaceMesh& mesh) {
        TESSERA_TRY(open_texture());
        TESSERA_TRY_ASSIGN(auto view, GlViewRenderer::create(*texture_, mesh));
        view_.emplace(std::move(view));
        return {};
    }

    Result<View> render(const Camera& camera) override {
        if (window_)
            TESSERA_TRY(check_side(*window_, camera));
        TESSERA_TRY(context_.make_current());
        TESSERA_TRY_ASSIGN(const auto report,
                           draw(gpu_camera(camera, window_.value_or(SphereWindow{}), background_)));
        if (texture_->damaged_tiles() > 0)
            return Status(ErrorCode::invalid_file,
                          reader_.name() + ": " + std::to_string(texture_->damaged_tiles()) +
                              " tiles are damaged; tessera validate lists them");
        auto view = read_view(camera.width, camera.height);
        if (view.ok())
            view->remark = remark_on(report);
        return view;
    }

    void watch(FrameHook hook) override { hook_ = std::move(hook); }

    std::optional<DeviceUse> device_use() const override {
        return DeviceUse{context_.device(), texture_->bytes() + view_->bytes()};
    }

private:
    Status open_texture() {
        SampledTextureOptions options;
        options.residency = options_.via == "gpu"    ? choose_residency(reader_, budget())
                            : options_.via == "load" ? Residency::on_load
                                                     : Residency::on_feedback;
        options.budget = budget();
        options.jobs_per_update = options_.tiles_per_frame;
        options.coarse_from = {options_.coarse_level, options_.coarse_texels};
        // Without a coarse level, the coarse texels are the means of all tiles, and a partial file
        // does not have all of them.
        options.coarse = options_.coarse_texels != nullptr || !reader_.is_partial();
        TESSERA_TRY_ASSIGN(auto texture, SampledTexture::create(reader_, options));
        texture_.emplace(std::move(texture));
        by_frames_ = options.residency == Residency::on_feedback;
        return {};
    }

    std::uint64_t budget() const { return std::uint64_t{options_.budget_mib} << 20; }

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
            TESSERA_TRY_ASSIGN(report, texture_->update(true));
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
               "M and are drawn coarsely; --budget " +
               std::to_string((texture_->budget_for(report.touched) >> 20) + 1) +
               "M would hold all of them";
    }

    HeadlessContext context_;
    const ContainerReader& reader_;
    std::optional<SphereWindow> window_; // absent: a mesh
    glm::dvec3 background_;
    GpuRenderOptions options_;
    std::optional<SampledTexture> texture_;
    std::optional<GlViewRenderer> view_;
    bool by_frames_ = false;
    FrameHook hook_;
    Traffic told_; // reported to the hook so far
};

template <class Surface>
Result<std::unique_ptr<ViewRenderer>>
make_renderer(const ContainerReader& reader, const Surface& surface, const glm::dvec3& background,
              const GpuRenderOptions& options) {
    auto context = HeadlessContext::create();
    if (!context.ok())
        return or_by_cpu(context.status(), options.via);
    auto renderer = std::make_unique<GpuRenderer>(std::move(*context), reader, background, options);
    const Status opened = renderer->open(surface);
    if (!opened.ok())
        return or_by_cpu(opened, options.via);
    return std::unique_ptr<ViewRenderer>(std::move(renderer));
}

} // namespace
#else
namespace {

template <class Surface>
Result<std::unique_ptr<ViewRenderer>> make_renderer(const ContainerReader&, const Surface&,
                                                    const glm::dvec3&,
                                                    const GpuRenderOptions& options) {
    return or_by_cpu({ErrorCode::unsupported, "this build has no GPU support (TESSERA_GPU is off)"},
                     options.via);
}

} // namespace
#endif

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SphereWindow& window,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options) {
    return make_renderer(reader, window, background, options);
}

Result<std::unique_ptr<ViewRenderer>> make_gpu_renderer(const ContainerReader& reader,
                                                        const SurfaceMesh& mesh,
                                                        const glm::dvec3& background,
                                                        const GpuRenderOptions& options) {
    return make_renderer(reader, mesh, background, options);
}

} // namespace tessera
