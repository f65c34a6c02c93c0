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
        return {ErrorCode::bad_argument,
                "'" + a.target + "' is nothing that can be measured; gpu is"};
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
    view.orbit = 360;
    c.add_option("--eye", view.eye, "Where the first frame is seen from, x,y,z (10,0,0)");
    c.add_option("--look", view.look, "A point straight ahead, x,y,z (0,0,0)");
    c.add_option("--fov", view.fov, "Vertical field of view in degrees")->capture_default_str();
    c.add_option("--orbit", view.orbit,
                 "Frames of a whole turn around the vertical line through the look point: 360 is a "
                 "degree a frame")
        ->check(CLI::Range(1u, 100000u))
        ->capture_default_str();
    c.add_option("--size", view.size,
                 "Pixels of a frame, WxH (1920x1080; 640x360 on a software device)");
}

} // namespace

void add_bench_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, BenchCommand& a) {
        GpuBenchOptions& o = a.options;
        c.add_option("target", a.target, "What to measure: gpu")->required();
        c.add_option(
             "file", a.file,
             "A .tess with a texture on a sphere or a mesh, or the URL of one (http, https)")
            ->required();
        declare_path(c, o.view);
        c.add_option("--frames", o.frames, "Frames measured in each way (100; software 10)")
            ->check(CLI::Range(1u, 100000u));
        c.add_option("--warm-up", o.warm_up, "Frames drawn before those (30; software 2)")
            ->check(CLI::Range(0u, 100000u));
        c.add_option("--budget", o.budget_mib,
                     "Memory on the device for the tile cache and all that belongs to it: 64M, 2G, "
                     "or a number of MiB (default: a fifth of the decoded texture, or for small "
                     "files what a view needs)")
            ->transform(mebibytes())
            ->type_name("SIZE");
        c.add_option("--original", o.original,
                     "The uncompressed texture (raw or .tess) to draw as raw and to measure PSNR "
                     "against; without it, the texels as the CPU decodes them");
        c.add_option("--skip", o.skip, "Leave out some of raw,load,feedback,decode")
            ->delimiter(',')
            ->check(one_of({"raw", "load", "feedback", "decode"}));
        c.add_flag("--json", a.json, "Print JSON");
        c.add_flag("--quiet,-q", a.quiet, "No progress");
    };
    add_verb<BenchCommand>(
        app, chosen, "bench", "Measure drawing a texture on the GPU",
        "Rows, all drawn along the same path in one run:\n"
        "  raw       an ordinary texture, as a renderer without this codec holds it\n"
        "  load      the same, decoded on the GPU\n"
        "  feedback  a cache of the tiles that frames touch. Cold: the cache is empty; a frame\n"
        "            that marks its tiles, decoding them, and the frame drawn from them. Steady:\n"
        "            along the orbit, with what little each frame decodes\n"
        "'16' fetches texels one by one, '4 filtered' lets the texture unit mix them.\n\n"
        "ms is a frame's time by the GPU's clock, decoding included, the median and what 95 in "
        "100\n"
        "frames stay below; wall ms by the host's. Of a software device ms is processor time\n"
        "of all threads, and neither says anything about GPUs. PSNR is of the first view as "
        "displayed, 8 bits; 'same' is\n"
        "without any difference. Late: tiles that found no slot. Then, for decoding alone, what "
        "its\n"
        "stages take: uploading, entropy decoding, sorting the levels, and the inverse transform\n"
        "with colour and writing.\n\n"
        "Examples:\n"
        "  tessera bench gpu scene.tess\n"
        "  tessera bench gpu scene.tess --original scene.rgb --size 1280x720 --json\n"
        "  tessera bench gpu scene.tess --budget 64 --skip raw,load",
        declare, run);
}

} // namespace tessera
