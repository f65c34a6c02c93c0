#include "tools/lab/bench/gpu_bench.h"
#include "tools/support/option_checks.h"
#include "tools/support/progress.h"
#include "tools/verbs/command.h"

#include <cstdio>

namespace tessera {
namespace {

struct BenchCommand {
    std::string target, file;
    GpuBenchOptions options;
    bool json = false, quiet = false;
};

Status run(const BenchCommand& a) {
    if (a.target != "gpu")
        return {ErrorCode::bad_argument, "'" + a.target + "' cannot be measured; only gpu can"};
    GpuBenchOptions options = a.options;
    Result<BenchReport> report = Status();
    {
        Progress progress("tessera bench", a.quiet);
        options.progress = progress.function();
        report = bench_gpu(a.file, options);
    }
    TESSERA_TRY(report);
    if (a.json)
        print_json(to_json(*report));
    else
        std::fputs(to_text(*report).c_str(), stdout);
    return {};
}

void declare_path(CLI::App& c, ViewRequest& view) {
    OptionGroup group(c, "Camera");
    view.orbit = 360;
    group.option("--eye", "X,Y,Z", view.eye, "Position of the first frame. Default: 10,0,0");
    group.option("--look", "X,Y,Z", view.look, "A point straight ahead. Default: 0,0,0");
    group.option("--fov", "DEGREES", view.fov, "Vertical field of view. Default: 45");
    group.option("--orbit", "N", view.orbit,
                 "Frames per turn around the vertical line through --look. Default: 360",
                 CLI::Range(1u, 100000u));
    group.option("--pixels", "WxH", view.size,
                 "Frame size. Default: 1920x1080, or 640x360 on a software device");
}

void declare(CLI::App& c, BenchCommand& a) {
    GpuBenchOptions& o = a.options;
    c.add_option("target", a.target, "What to measure: gpu")->required();
    c.add_option("file", a.file,
                 "A .tess with a texture on a sphere or a mesh, or its URL (http, https)")
        ->required();
    c.add_option("--frames", o.frames,
                 "Frames to measure per row. Default: 100, or 10 on a software device")
        ->check(CLI::Range(1u, 100000u))
        ->option_text("N");
    c.add_option("--warm-up", o.warm_up,
                 "Frames to draw before measuring. Default: 30, or 2 on a software device")
        ->check(CLI::Range(0u, 100000u))
        ->option_text("N");
    c.add_option("--budget", o.budget_mib,
                 "GPU memory for the tile cache and its buffers. Default: a fifth of the decoded "
                 "texture, or more if the first view needs it")
        ->transform(size_in_mebibytes())
        ->option_text("SIZE");
    c.add_option("--original", o.original,
                 "The uncompressed texture (raw or .tess) for the raw rows and for PSNR. Default: "
                 "the texels that the CPU decodes")
        ->option_text("FILE");
    c.add_option("--skip", o.skip, "Rows to leave out, a list of raw, load, feedback, decode")
        ->delimiter(',')
        ->check(one_of({"raw", "load", "feedback", "decode"}))
        ->option_text("LIST");
    c.add_flag("--json", a.json, "Print JSON");
    c.add_flag("--quiet,-q", a.quiet, "No progress");
    declare_path(c, o.view);
}

} // namespace

void add_bench_command(CLI::App& app, Invocation& chosen) {
    add_verb<BenchCommand>(
        app, chosen, "bench", "Measure drawing a texture on the GPU",
        "All rows draw the same camera path in one run:\n"
        "  raw       an ordinary texture, as a renderer without this codec uses it\n"
        "  load      the same texture, decoded on the GPU\n"
        "  feedback  a cache of the tiles that frames touch. A cold frame starts with an empty "
        "cache: it is drawn once to mark its tiles, the tiles are decoded, and it is drawn again. "
        "Steady frames follow the orbit, and each decodes the few tiles that it adds\n"
        "With '16' the shader fetches texels one by one; with '4 filtered' the texture unit "
        "interpolates them.\n\n"
        "ms is the median time of a frame by the GPU's clock, including decoding; the next column "
        "is the 95th percentile. wall ms is the time by the host's clock. For a software device, "
        "ms is the processor time of all threads, and neither time says anything about GPUs. PSNR "
        "compares the first view as displayed, in 8 bits; 'same' means no difference. Late counts "
        "tiles for which the cache had no slot. The last rows time the stages of decoding alone: "
        "upload, entropy decoding, sorting the levels, and the inverse transform with colour "
        "conversion and writing.\n\n"
        "Examples:\n"
        "  tessera bench gpu scene.tess\n"
        "  tessera bench gpu scene.tess --original scene.rgb --pixels 1280x720 --json\n"
        "  tessera bench gpu scene.tess --budget 64M --skip raw,load",
        declare, run);
}

} // namespace tessera
