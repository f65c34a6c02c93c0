#include "tools/lab/bench/gpu_bench.h"

#ifdef TESSERA_GPU
#include "codec/metrics.h"
#include "decoder_glsl/gl_context.h"
#include "tools/http/open_bytes.h"
#include "tools/lab/bench/gpu_stage_times.h"
#include "tools/lab/bench/gpu_times.h"
#include "tools/support/interrupt.h"
#include "tools/texture_io/texture_io.h"
#include "tools/view/gpu_camera.h"
#include "tools/view/mesh_renderer.h"
#include "tools/view/render_stage.h"
#include "tools/view/view_file.h"
#include "tools/view/view_report.h"

#include <algorithm>
#include <chrono>

namespace tessera {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// How much to draw. A GPU draws a thousand frames in the time that a software device needs for a
// few.
struct Amount {
    const char* size;
    unsigned frames, warm_up, cold_frames, repeats;
};
constexpr Amount on_hardware{"1920x1080", 100, 30, 20, 10};
constexpr Amount on_software{"640x360", 10, 2, 3, 1};

// A fixed view usually settles in two frames: the first marks its tiles, the second shows them.
constexpr int most_settling_frames = 8;

// A texture and its renderer. The order of the members makes the renderer die first.
struct Subject {
    SampledTexture texture;
    std::optional<GlViewRenderer> view;
};

class GpuBench {
public:
    GpuBench(const Decoder& decoder, const HeadlessContext& context, const GpuBenchOptions& options)
        : decoder_(decoder), reader_(decoder.container()), options_(options),
          amount_(context.is_software() ? on_software : on_hardware),
          clock_(context.is_software() ? TimerClock::processor : TimerClock::device) {
        report_.device = context.device();
        report_.vendor = context.vendor();
        report_.driver = context.version();
        report_.software = context.is_software();
        report_.frames = options.frames.value_or(amount_.frames);
        report_.warm_up = options.warm_up.value_or(amount_.warm_up);
        report_.cold_frames = amount_.cold_frames;
        report_.orbit = options.view.orbit;
        report_.tiles = reader_.grid().tiles();
        report_.size = to_string(reader_.desc().size);
        report_.decoded_bytes = decoded_bytes(reader_);
    }

    Status run() {
        TESSERA_TRY(plan_cameras());
        if (wants("raw"))
            TESSERA_TRY(run_raw());
        if (wants("load"))
            TESSERA_TRY(run_load());
        if (wants("feedback"))
            TESSERA_TRY(run_feedback());
        if (wants("decode"))
            TESSERA_TRY(run_decode());
        return {};
    }
    BenchReport& report() { return report_; }

private:
    bool wants(const char* name) const {
        return std::find(options_.skip.begin(), options_.skip.end(), name) == options_.skip.end();
    }
    void show(const BenchRow& row, double done, double total) const {
        if (options_.progress)
            options_.progress((row.via + " " + row.frame).c_str(), done, total);
    }

    Status plan_cameras() {
        ViewRequest request = options_.view;
        if (request.size.empty())
            request.size = amount_.size;
        TESSERA_TRY_ASSIGN(const auto plan, plan_views(request));
        TESSERA_TRY_ASSIGN(mesh_, mesh_surface(reader_));
        SphereWindow window; // at the origin of a mesh's coordinates
        if (!mesh_) {
            TESSERA_TRY_ASSIGN(window,
                               sphere_window(reader_.description()).with_context(reader_.name()));
        }
        for (const PlannedView& view : plan) {
            if (!mesh_)
                TESSERA_TRY(check_side(window, view.camera).with_context(view.name));
            cameras_.push_back(gpu_camera(view.camera, window, glm::dvec3(0)));
        }
        report_.width = cameras_.front().width;
        report_.height = cameras_.front().height;
        return {};
    }
    Result<GlViewRenderer> view_of(const SampledTexture& texture) const {
        return mesh_ ? GlViewRenderer::create(texture, mesh_->mesh)
                     : GlViewRenderer::create(texture);
    }
    const ViewCamera& camera(unsigned frame) const { return cameras_[frame % cameras_.size()]; }

    // Creates a subject and passes it to `measure`. If it cannot be created, all of `rows` get the
    // reason.
    template <class Make, class Measure>
    Status with_subject(std::vector<BenchRow>& rows, const Make& make, const Measure& measure) {
        TESSERA_TRY(check_interrupt());
        const auto give_up = [&](const Status& status) -> Status {
            if (status.code() != ErrorCode::unsupported && status.code() != ErrorCode::runtime)
                return status;
            for (BenchRow& row : rows)
                row.missing = status.message();
            return {};
        };
        Result<SampledTexture> texture = make();
        if (!texture.ok())
            return give_up(texture.status());
        if (texture->damaged_tiles() > 0)
            return {ErrorCode::invalid_file,
                    reader_.name() + ": has damaged tiles; tessera validate lists them"};
        Subject subject{std::move(*texture), std::nullopt};
        auto view = view_of(subject.texture);
        if (!view.ok())
            return give_up(view.status());
        subject.view.emplace(std::move(*view));
        TESSERA_TRY(measure(subject));
        return subject.texture.damaged_tiles() == 0
                   ? Status()
                   : Status(ErrorCode::invalid_file, reader_.name() + ": has damaged tiles");
    }
    template <class Make> Status plain_row(BenchRow row, const Make& make) {
        std::vector<BenchRow> rows{std::move(row)};
        TESSERA_TRY(with_subject(rows, make, [&](Subject& subject) -> Status {
            TESSERA_TRY(measure_steady(subject, rows[0]));
            return measure_fixed_view(subject, rows[0]);
        }));
        report_.rows.push_back(std::move(rows[0]));
        return {};
    }
    static BenchRow row_of(const char* via, bool filter, const char* frame) {
        BenchRow row;
        row.via = via;
        row.fetches = filter ? "4 filtered" : "16";
        row.frame = frame;
        return row;
    }
    SampledTextureOptions with(Residency residency, bool filter, std::uint64_t budget) const {
        SampledTextureOptions options;
        options.residency = residency;
        options.hardware_filter = filter;
        options.budget = budget;
        return options;
    }
    // A budget that does not limit: the whole texture and the memory to decode it.
    std::uint64_t enough() const { return report_.decoded_bytes + (512ull << 20); }

    Status run_raw() {
        TESSERA_TRY_ASSIGN(auto source, open_texels());
        for (const bool filter : {false, true})
            TESSERA_TRY(plain_row(row_of("raw", filter, "steady"), [&] {
                return SampledTexture::from_texels(reader_, *source, filter);
            }));
        return {};
    }

    // Opens the uncompressed texture if there is one, else the texels that the CPU decodes.
    Result<std::unique_ptr<TexelSource>> open_texels() {
        reference_name_ = "the texels decoded by the CPU";
        if (options_.original.empty())
            return interruptible(decoded_source(decoder_));
        TESSERA_TRY_ASSIGN(auto original, open_original(options_.original, reader_.desc()));
        if (original->desc() != reader_.desc())
            return Status(ErrorCode::bad_argument, options_.original +
                                                       ": does not have the size and " +
                                                       "type of " + reader_.name());
        reference_name_ = options_.original;
        return interruptible(std::move(original));
    }

    Status run_load() {
        for (const bool filter : {false, true})
            TESSERA_TRY(plain_row(row_of("load", filter, "steady"), [&] {
                return SampledTexture::create(reader_, with(Residency::on_load, filter, enough()));
            }));
        return {};
    }

    Status run_feedback() {
        for (const bool filter : {false, true}) {
            std::vector<BenchRow> rows{row_of("feedback", filter, "cold"),
                                       row_of("feedback", filter, "steady")};
            TESSERA_TRY(with_subject(
                rows, [&] { return make_cache(filter); },
                [&](Subject& subject) -> Status {
                    TESSERA_TRY(measure_cold(subject, rows[0]));
                    TESSERA_TRY(measure_steady(subject, rows[1]));
                    TESSERA_TRY(measure_fixed_view(subject, rows[1]));
                    return filter && wants("decode") ? measure_stages(subject) : Status();
                }));
            report_.rows.insert(report_.rows.end(), rows.begin(), rows.end());
        }
        return {};
    }

    // Creates a cache within the requested budget, or finds a budget as bench_gpu() describes.
    Result<SampledTexture> make_cache(bool filter) {
        if (options_.budget_mib)
            report_.budget = std::uint64_t{*options_.budget_mib} << 20;
        else if (report_.budget == 0)
            report_.budget = report_.decoded_bytes / 5;
        for (;;) {
            auto texture = SampledTexture::create(
                reader_, with(Residency::on_feedback, filter, report_.budget));
            if (options_.budget_mib)
                return texture;
            const auto enough_slots = texture.ok() ? has_enough_slots(*texture) : texture.status();
            if (enough_slots.ok() && *enough_slots)
                return texture;
            if (report_.budget > enough() ||
                (!enough_slots.ok() && enough_slots.status().code() != ErrorCode::unsupported))
                return enough_slots.ok() ? std::move(texture) : enough_slots.status();
            TESSERA_TRY(check_interrupt());
            report_.budget += report_.budget / 2 + (1u << 16);
        }
    }

    // Returns whether the cache has a quarter more slots than the first view touches.
    Result<bool> has_enough_slots(SampledTexture& texture) {
        if (touched_ == 0) {
            TESSERA_TRY_ASSIGN(auto view, view_of(texture));
            TESSERA_TRY(view.draw(camera(0)));
            TESSERA_TRY_ASSIGN(const auto update, texture.update(true));
            touched_ = update.touched;
        }
        return texture.cache_slots() >= std::min(touched_ + touched_ / 4, report_.tiles);
    }

    Status measure_steady(Subject& subject, BenchRow& row) {
        const bool cached = subject.texture.cache_slots() > 0;
        TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(cached ? 6 : 3, clock_));
        const unsigned all = report_.warm_up + report_.frames;
        std::vector<double> wall;
        std::vector<std::uint32_t> decoded;
        double touched = 0, waiting = 0;
        for (unsigned frame = 0; frame < all; ++frame) {
            TESSERA_TRY(check_interrupt());
            show(row, frame, all);
            const auto start = Clock::now();
            log.begin();
            TESSERA_TRY(subject.view->draw(camera(frame)));
            log.end();
            if (cached) {
                log.begin();
                TESSERA_TRY_ASSIGN(const auto update, subject.texture.update(false));
                log.end();
                decoded.push_back(update.decoded);
                touched += frame < report_.warm_up ? 0 : update.touched;
                waiting += frame < report_.warm_up ? 0 : update.waiting;
            }
            wall.push_back(milliseconds_since(start));
        }
        const std::vector<double>& times = log.finish();
        std::vector<double> draws, updates, frames;
        double decoding = 0, tiles = 0;
        for (std::size_t frame = report_.warm_up; frame < all; ++frame) {
            draws.push_back(times[cached ? 2 * frame : frame]);
            updates.push_back(cached ? times[2 * frame + 1] : 0);
            frames.push_back(draws.back() + updates.back());
            if (cached && decoded[frame] > 0) {
                decoding += updates.back();
                tiles += decoded[frame];
            }
        }
        wall.erase(wall.begin(), wall.begin() + report_.warm_up);
        row.device = spread_of(std::move(frames));
        row.wall = spread_of(std::move(wall));
        row.draw = spread_of(std::move(draws));
        row.update = spread_of(std::move(updates));
        row.touched = touched / report_.frames;
        row.decoded = tiles / report_.frames;
        row.waiting = waiting / report_.frames;
        if (decoding > 0)
            row.texels_per_second = tiles * texels_of_a_tile() / decoding * 1e3;
        return {};
    }

    Status measure_cold(Subject& subject, BenchRow& row) {
        TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(3, clock_));
        std::vector<double> wall;
        UpdateReport update;
        const unsigned all = report_.cold_frames + 1; // the first frame warms up
        for (unsigned frame = 0; frame < all; ++frame) {
            TESSERA_TRY(check_interrupt());
            show(row, frame, all);
            TESSERA_TRY(subject.texture.drop_cache());
            glFinish();
            const auto start = Clock::now();
            log.begin();
            TESSERA_TRY(subject.view->draw(camera(0)));
            log.end();
            log.begin();
            TESSERA_TRY_ASSIGN(const auto updated, subject.texture.update(true));
            log.end();
            log.begin();
            TESSERA_TRY(subject.view->draw(camera(0)));
            log.end();
            glFinish();
            wall.push_back(milliseconds_since(start));
            update = updated;
        }
        const std::vector<double>& times = log.finish();
        std::vector<double> marks, decodes, draws, frames;
        for (std::size_t frame = 1; frame < all; ++frame) {
            marks.push_back(times[3 * frame]);
            decodes.push_back(times[3 * frame + 1]);
            draws.push_back(times[3 * frame + 2]);
            frames.push_back(marks.back() + decodes.back() + draws.back());
        }
        wall.erase(wall.begin());
        row.device = spread_of(std::move(frames));
        row.wall = spread_of(std::move(wall));
        row.mark = spread_of(std::move(marks));
        row.decode = spread_of(std::move(decodes));
        row.redraw = spread_of(std::move(draws));
        row.touched = update.touched;
        row.decoded = update.decoded;
        row.waiting = update.waiting;
        if (row.decode.median > 0)
            row.texels_per_second = row.decoded * texels_of_a_tile() / row.decode.median * 1e3;
        return compare(subject, row);
    }

    double texels_of_a_tile() const {
        return static_cast<double>(texel_count(reader_.desc().size)) /
               static_cast<double>(report_.tiles);
    }

    // Draws the first view until all its tiles are in the cache, and compares it.
    Status measure_fixed_view(Subject& subject, BenchRow& row) {
        for (int frame = 0; frame < most_settling_frames; ++frame) {
            TESSERA_TRY(check_interrupt());
            TESSERA_TRY(subject.view->draw(camera(0)));
            TESSERA_TRY_ASSIGN(const auto update, subject.texture.update(true));
            if (update.decoded == 0)
                break;
        }
        return compare(subject, row);
    }

    // Compares the frame just drawn with the reference. The first frame of raw texels becomes the
    // reference.
    Status compare(Subject& subject, BenchRow& row) {
        TESSERA_TRY_ASSIGN(const auto pixels, subject.view->read());
        View view;
        view.width = report_.width;
        view.height = report_.height;
        view.rgb.reserve(pixels.size() / 4 * 3);
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            view.rgb.insert(view.rgb.end(), {pixels[i], pixels[i + 1], pixels[i + 2]});
        Picture picture = to_picture(view, reader_.desc().type);
        row.bytes = subject.texture.bytes();
        row.slots = subject.texture.cache_slots();
        if (!reference_ && row.via == "raw") {
            reference_ = std::move(picture);
            report_.reference = "raw, 16 fetches, of " + reference_name_;
            row.psnr = psnr_of(0, 255);
        } else if (reference_) {
            row.psnr = likeness_of(*reference_, picture).psnr;
        }
        return {};
    }

    // Times the stages of decoding in a cold frame, and in the frames after it.
    Status measure_stages(Subject& subject) {
        TESSERA_TRY_ASSIGN(auto log, StageLog::create(clock_));
        subject.texture.set_stage_hook(log.hook());
        BenchDecode cold, steady;
        cold.what = "cold frame";
        steady.what = "steady frames";
        TESSERA_TRY(subject.texture.drop_cache());
        for (unsigned frame = 0; frame <= report_.frames; ++frame) {
            TESSERA_TRY(check_interrupt());
            TESSERA_TRY(subject.view->draw(camera(frame)));
            TESSERA_TRY_ASSIGN(const auto update, subject.texture.update(true));
            BenchDecode& times = frame == 0 ? cold : steady;
            times.tiles += update.decoded;
            log.take(times);
        }
        subject.texture.set_stage_hook({});
        for (BenchDecode* times : {&cold, &steady}) {
            if (times->tiles == 0)
                times->missing = "no tile had to be decoded";
            times->texels =
                static_cast<std::uint64_t>(static_cast<double>(times->tiles) * texels_of_a_tile());
            report_.decodes.push_back(*times);
        }
        return {};
    }

    Status run_decode() {
        if (options_.progress)
            options_.progress("decoding the whole file", 0, 1);
        const auto whole = time_whole_decode(reader_, clock_, amount_.repeats);
        BenchDecode times;
        if (whole.ok()) {
            times = whole->times;
            report_.blocks = whole->blocks;
            report_.coefficients = whole->coefficients;
        } else if (whole.status().code() == ErrorCode::unsupported) {
            times.missing = whole.status().message();
        } else {
            return whole.status();
        }
        times.what = "whole file";
        report_.decodes.insert(report_.decodes.begin(), times);
        return {};
    }

    const Decoder& decoder_;
    const ContainerReader& reader_;
    const GpuBenchOptions& options_;
    const Amount amount_;
    const TimerClock clock_;
    std::optional<MeshSurface> mesh_;
    std::vector<ViewCamera> cameras_; // one turn of the orbit
    std::optional<Picture> reference_;
    std::string reference_name_;
    std::uint64_t touched_ = 0; // tiles that the first view touches
    BenchReport report_;
};

} // namespace

Result<BenchReport> bench_gpu(const std::string& file, const GpuBenchOptions& options) {
    TESSERA_TRY_ASSIGN(const auto bytes, open_tess_bytes(file, "bench"));
    TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(*bytes));
    TESSERA_TRY_ASSIGN(const auto context, HeadlessContext::create());
    GpuBench bench(decoder, context, options);
    TESSERA_TRY(bench.run());
    BenchReport report = std::move(bench.report());
    report.file = file;
    report.file_bytes = bytes->size();
    report.bits_per_texel = static_cast<double>(report.file_bytes) * 8 /
                            static_cast<double>(texel_count(decoder.desc().size));
    return report;
}

} // namespace tessera
#else

namespace tessera {

Result<BenchReport> bench_gpu(const std::string&, const GpuBenchOptions&) {
    return Status(ErrorCode::unsupported, "this build has no GPU support (TESSERA_GPU is off)");
}

} // namespace tessera
#endif
