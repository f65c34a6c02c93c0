#include "tools/lab/bench/gpu_bench.h"

#ifdef TESSERA_GPU
#include "codec/metrics.h"
#include "decoder_glsl/gl_context.h"
#include "tools/http/open_bytes.h"
#include "tools/lab/bench/bench_subject.h"
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
#include <array>
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

class GpuBench {
public:
    // `file` has no mesh yet.
    GpuBench(BenchFile file, const HeadlessContext& context, const GpuBenchOptions& options)
        : file_(std::move(file)), reader_(file_.reader(0)), options_(options),
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
        report_.tiles = file_.tiles();
        report_.size = to_string(reader_.desc().size);
        report_.layers = has_layers() ? file_.textures() : 0;
        report_.decoded_bytes = file_.decoded_bytes();
    }

    Status run() {
        TESSERA_TRY(plan_cameras());
        if (has_layers() && wants("first"))
            TESSERA_TRY(run_first());
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
    bool has_layers() const { return file_.textures() > 1; }
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
        if (mesh_)
            file_.mesh = &mesh_->mesh;
        else if (has_layers())
            return {ErrorCode::unsupported, reader_.name() + ": its layers do not lie on a mesh"};
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
        Result<BenchSubject> subject = BenchSubject::create(file_, make);
        if (!subject.ok())
            return give_up(subject.status());
        TESSERA_TRY(measure(*subject));
        return subject->check_damage();
    }
    template <class Make> Status plain_row(BenchRow row, const Make& make) {
        std::vector<BenchRow> rows{std::move(row)};
        TESSERA_TRY(with_subject(rows, make, [&](BenchSubject& subject) -> Status {
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
    using Textures = Result<std::vector<SampledTexture>>;
    // The first textures of the file.
    Textures create(std::size_t count, Residency residency, bool filter,
                    std::uint64_t budget) const {
        std::vector<SampledTextureRequest> requests;
        for (std::size_t i = 0; i < count; ++i) {
            requests.push_back({&file_.reader(i), {}});
            requests.back().options.residency = residency;
            requests.back().options.hardware_filter = filter;
            requests.back().options.mesh = file_.mesh;
        }
        return SampledTexture::create(requests, budget);
    }
    // A budget that does not limit: the whole texture and the memory to decode it.
    std::uint64_t enough() const { return report_.decoded_bytes + (512ull << 20); }

    // What a renderer of ordinary textures would draw: the first layer alone.
    Status run_first() {
        for (const bool filter : {false, true})
            TESSERA_TRY(plain_row(row_of("first", filter, "steady"),
                                  [&] { return create(1, Residency::on_load, filter, enough()); }));
        return {};
    }

    Status run_raw() {
        std::vector<std::unique_ptr<TexelSource>> sources;
        for (std::size_t i = 0; i < file_.textures(); ++i) {
            TESSERA_TRY_ASSIGN(auto source, open_texels(i));
            sources.push_back(std::move(source));
        }
        for (const bool filter : {false, true})
            TESSERA_TRY(plain_row(row_of("raw", filter, "steady"), [&]() -> Textures {
                std::vector<SampledTexture> textures;
                for (std::size_t i = 0; i < sources.size(); ++i) {
                    TESSERA_TRY_ASSIGN(auto texture,
                                       SampledTexture::from_texels(file_.reader(i), *sources[i],
                                                                   filter, file_.mesh));
                    textures.push_back(std::move(texture));
                }
                return textures;
            }));
        return {};
    }

    // Opens the uncompressed texture if there is one, else the texels that the CPU decodes.
    Result<std::unique_ptr<TexelSource>> open_texels(std::size_t texture) {
        reference_name_ = "the texels decoded by the CPU";
        if (options_.original.empty())
            return interruptible(decoded_source(file_.decoder(texture)));
        if (has_layers())
            return Status(ErrorCode::unsupported,
                          reader_.name() + ": --original cannot be used with layers");
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
                return create(file_.textures(), Residency::on_load, filter, enough());
            }));
        return {};
    }

    Status run_feedback() {
        for (const bool filter : {false, true}) {
            std::vector<BenchRow> rows{row_of("feedback", filter, "cold"),
                                       row_of("feedback", filter, "steady")};
            TESSERA_TRY(with_subject(
                rows, [&] { return make_caches(filter); },
                [&](BenchSubject& subject) -> Status {
                    TESSERA_TRY(measure_cold(subject, rows[0]));
                    TESSERA_TRY(measure_steady(subject, rows[1]));
                    TESSERA_TRY(measure_fixed_view(subject, rows[1]));
                    return filter && wants("decode") ? measure_stages(subject) : Status();
                }));
            report_.rows.insert(report_.rows.end(), rows.begin(), rows.end());
        }
        return {};
    }

    // Creates caches within the requested budget, or finds a budget as bench_gpu() describes.
    Textures make_caches(bool filter) {
        const auto caches = [&] {
            return create(file_.textures(), Residency::on_feedback, filter, report_.budget);
        };
        if (options_.budget_mib) {
            report_.budget = std::uint64_t{*options_.budget_mib} << 20;
            return caches();
        }
        if (report_.budget == 0) { // once for both filters
            TESSERA_TRY_ASSIGN(report_.budget, find_budget());
        }
        return caches();
    }

    // Draws the first view with the smallest budget that is possible, to learn what it touches.
    Result<std::uint64_t> find_budget() {
        for (std::uint64_t budget = report_.decoded_bytes / 5;; budget += budget / 2 + (1u << 16)) {
            TESSERA_TRY(check_interrupt());
            auto subject = BenchSubject::create(file_, [&] {
                return create(file_.textures(), Residency::on_feedback, false, budget);
            });
            if (!subject.ok() && subject.status().code() == ErrorCode::unsupported &&
                budget <= enough())
                continue;
            TESSERA_TRY(subject);
            TESSERA_TRY(subject->draw(camera(0)));
            TESSERA_TRY(subject->update(true));
            return std::max(budget, subject->roomy_budget());
        }
    }

    Status measure_steady(BenchSubject& subject, BenchRow& row) {
        const bool cached = subject.slots() > 0;
        TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(cached ? 6 : 3, clock_));
        const unsigned all = report_.warm_up + report_.frames;
        std::vector<double> wall;
        std::vector<BenchSubject::Update> seen;
        double touched = 0, waiting = 0;
        for (unsigned frame = 0; frame < all; ++frame) {
            TESSERA_TRY(check_interrupt());
            show(row, frame, all);
            const auto start = Clock::now();
            log.begin();
            TESSERA_TRY(subject.draw(camera(frame)));
            log.end();
            if (cached) {
                log.begin();
                TESSERA_TRY_ASSIGN(const auto update, subject.update(false));
                log.end();
                seen.push_back(update);
                touched += frame < report_.warm_up ? 0 : update.touched;
                waiting += frame < report_.warm_up ? 0 : update.waiting;
            }
            wall.push_back(milliseconds_since(start));
        }
        const std::vector<double>& times = log.finish();
        std::vector<double> draws, updates, frames;
        double decoding = 0, tiles = 0, texels = 0;
        for (std::size_t frame = report_.warm_up; frame < all; ++frame) {
            draws.push_back(times[cached ? 2 * frame : frame]);
            updates.push_back(cached ? times[2 * frame + 1] : 0);
            frames.push_back(draws.back() + updates.back());
            if (cached && seen[frame].decoded > 0) {
                decoding += updates.back();
                tiles += seen[frame].decoded;
                texels += seen[frame].texels;
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
            row.texels_per_second = texels / decoding * 1e3;
        return {};
    }

    Status measure_cold(BenchSubject& subject, BenchRow& row) {
        TESSERA_TRY_ASSIGN(auto log, IntervalLog::create(3, clock_));
        std::vector<double> wall;
        BenchSubject::Update update;
        const unsigned all = report_.cold_frames + 1; // the first frame warms up
        for (unsigned frame = 0; frame < all; ++frame) {
            TESSERA_TRY(check_interrupt());
            show(row, frame, all);
            TESSERA_TRY(subject.drop_cache());
            glFinish();
            const auto start = Clock::now();
            log.begin();
            TESSERA_TRY(subject.draw(camera(0)));
            log.end();
            log.begin();
            TESSERA_TRY_ASSIGN(const auto updated, subject.update(true));
            log.end();
            log.begin();
            TESSERA_TRY(subject.draw(camera(0)));
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
            row.texels_per_second = update.texels / row.decode.median * 1e3;
        return compare(subject, row);
    }

    // Draws the first view until all its tiles are in the cache, and compares it.
    Status measure_fixed_view(BenchSubject& subject, BenchRow& row) {
        for (int frame = 0; frame < most_settling_frames; ++frame) {
            TESSERA_TRY(check_interrupt());
            TESSERA_TRY(subject.draw(camera(0)));
            TESSERA_TRY_ASSIGN(const auto update, subject.update(true));
            if (update.decoded == 0)
                break;
        }
        return compare(subject, row);
    }

    // Compares the frame just drawn with the reference. The first frame of raw texels becomes the
    // reference.
    Status compare(BenchSubject& subject, BenchRow& row) {
        TESSERA_TRY_ASSIGN(const auto pixels, subject.read());
        View view;
        view.width = report_.width;
        view.height = report_.height;
        view.rgb.reserve(pixels.size() / 4 * 3);
        for (std::size_t i = 0; i < pixels.size(); i += 4)
            view.rgb.insert(view.rgb.end(), {pixels[i], pixels[i + 1], pixels[i + 2]});
        Picture picture = to_picture(view, reader_.desc().type);
        row.bytes = subject.bytes();
        row.slots = subject.slots();
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
    Status measure_stages(BenchSubject& subject) {
        TESSERA_TRY_ASSIGN(auto log, StageLog::create(clock_));
        subject.set_stage_hook(log.hook());
        BenchDecode cold, steady;
        std::array<double, 2> texels{};
        cold.what = "cold frame";
        steady.what = "steady frames";
        TESSERA_TRY(subject.drop_cache());
        for (unsigned frame = 0; frame <= report_.frames; ++frame) {
            TESSERA_TRY(check_interrupt());
            TESSERA_TRY(subject.draw(camera(frame)));
            TESSERA_TRY_ASSIGN(const auto update, subject.update(true));
            BenchDecode& times = frame == 0 ? cold : steady;
            times.tiles += update.decoded;
            texels[frame == 0 ? 0 : 1] += update.texels;
            log.take(times);
        }
        subject.set_stage_hook({});
        cold.texels = static_cast<std::uint64_t>(texels[0]);
        steady.texels = static_cast<std::uint64_t>(texels[1]);
        for (BenchDecode* times : {&cold, &steady}) {
            if (times->tiles == 0)
                times->missing = "no tile had to be decoded";
            report_.decodes.push_back(*times);
        }
        return {};
    }

    Status run_decode() {
        if (options_.progress)
            options_.progress("decoding the whole file", 0, 1);
        BenchDecode times;
        for (std::size_t i = 0; i < file_.textures() && times.missing.empty(); ++i) {
            const auto whole = time_whole_decode(file_.reader(i), clock_, amount_.repeats);
            if (!whole.ok() && whole.status().code() != ErrorCode::unsupported)
                return whole.status();
            if (!whole.ok()) {
                times.missing = whole.status().message();
                report_.blocks = report_.coefficients = 0;
                break;
            }
            times += whole->times;
            report_.blocks += whole->blocks;
            report_.coefficients += whole->coefficients;
        }
        times.what = "whole file";
        report_.decodes.insert(report_.decodes.begin(), times);
        return {};
    }

    BenchFile file_;
    const ContainerReader& reader_; // of the first texture
    const GpuBenchOptions& options_;
    const Amount amount_;
    const TimerClock clock_;
    std::optional<MeshSurface> mesh_;
    std::vector<ViewCamera> cameras_; // one turn of the orbit
    std::optional<Picture> reference_;
    std::string reference_name_;
    BenchReport report_;
};

} // namespace

Result<BenchReport> bench_gpu(const std::string& file, const GpuBenchOptions& options) {
    TESSERA_TRY_ASSIGN(const auto bytes, open_tess_bytes(file, "bench"));
    TESSERA_TRY_ASSIGN(const auto decoder, Decoder::open(*bytes));
    TESSERA_TRY_ASSIGN(const auto context, HeadlessContext::create());
    BenchFile textures;
    textures.first = &decoder;
    TESSERA_TRY_ASSIGN(textures.layers, open_layers(*bytes, decoder.container(), {}));
    textures.lights = decoder.container().layers().lights;
    GpuBench bench(std::move(textures), context, options);
    TESSERA_TRY(bench.run());
    BenchReport report = std::move(bench.report());
    report.file = file;
    report.file_bytes = bytes->size();
    if (report.layers == 0)
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
