#include "corpus/bake.h"
#include "tools/lab/rd/rd_run.h"
#include "tools/lab/rd/views_study.h"
#include "tools/support/option_checks.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/verbs/command.h"

namespace tessera {
namespace {

struct RdCommand {
    RdOptions options;
    TextureArguments texture;
    std::string views; // a scene
    bool json = false;
};

Status run_views(const RdCommand& a) {
    if (!a.options.textures.empty())
        return {ErrorCode::bad_argument, "--views bakes its own textures and accepts no others"};
    if (a.options.efforts.size() > 1)
        return {ErrorCode::bad_argument, "--views: --efforts must name a single effort"};
    TESSERA_TRY_ASSIGN(const TextureHints hints, make_hints(a.texture));
    ViewsOptions o{a.views, a.options.output, a.options.quick};
    if (!a.options.efforts.empty())
        o.effort = a.options.efforts.front();
    o.threads = hints.threads;
    o.quiet = a.texture.quiet || a.json;
    TESSERA_TRY_ASSIGN(const auto report, run_views_study(o));
    if (a.json)
        print_json(to_json(report));
    else if (!a.texture.quiet)
        std::printf("\n%s\nPlot: %s/views.svg\n", to_text(report).c_str(), o.output.c_str());
    return {};
}

Status run(const RdCommand& a) {
    if (!a.views.empty())
        return run_views(a);
    if (a.options.textures.empty())
        return {ErrorCode::bad_argument, "no texture; name one, or use --views SCENE"};
    RdOptions options = a.options;
    TESSERA_TRY_ASSIGN(options.hints, make_hints(a.texture));
    options.quiet = a.texture.quiet;
    options.print_lines = !a.texture.quiet && !a.json;
    TESSERA_TRY_ASSIGN(const auto report, run_rd(options));
    if (a.json)
        print_json(to_json(report));
    else if (!a.texture.quiet)
        std::printf("\n%s%s\n", to_text(report).c_str(),
                    ("Report: " + options.output + "/index.html").c_str());
    return {};
}

void declare_measurement(CLI::App& c, RdOptions& o) {
    OptionGroup group(c, "Measurements");
    group.flag(
        "--quick", o.quick,
        "Give a first plot in about a minute: a crop of 64x64x16x16 texels, effort 1, fast rivals");
    group.flag("--pictures", o.pictures,
               "Compare textures of one view with picture codecs. Unless other options say "
               "otherwise: effort 4, qualities 40, 48, 56, 64, 72 and 78, rivals avif, avif:planes "
               "and jxl, anchor avif");
    group.option("--psnr", "DB,DB,...", o.psnr, "Target PSNRs for tessera. Default: 35,38,41,44")
        ->delimiter(',')
        ->check(CLI::Range(1.0, 200.0));
    group
        .option("--quality", "1..100,...", o.quality,
                "Qualities for tessera, instead of or in addition to --psnr")
        ->delimiter(',')
        ->check(CLI::Range(1.0, 100.0));
    group
        .option("--efforts", "0..4,...", o.efforts,
                "Efforts for tessera. Default: 3, and one point each at 0 and 4")
        ->delimiter(',')
        ->check(CLI::Range(0, most_effort));
    group.option("--rivals", "LIST", o.rivals,
                 "all (default), none, or a list of x265, x265:8, x265:medium, aom, svtav1, avif, "
                 "avif:planes, avif:mosaic, jxl, astc, zfp:rate, zfp:accuracy, exr:dwaa, raw");
    group.option("--anchor", "ID", o.anchor,
                 "The codec that BD-rates refer to. Default: x265 if it ran (with --pictures "
                 "avif), else tessera");
    group.option("--spp", "N", o.samples, "Rays per texel of a scene. Default: 16",
                 CLI::Range(1u, corpus::max_samples_per_texel));
    group.flag(
        "--sphere", o.on_sphere,
        "Assume that the texture lies on the sphere of the scenes, and also measure rendered "
        "views");
    group.option("--cache", "FOLDER", o.cache,
                 "Folder of stored measurements. Default: OUTPUT/cache");
    group.flag("--keep", o.keep, "Keep the files that codecs read and write, in OUTPUT/bitstreams");
    group.option("--timeout", "SECONDS", o.timeout,
                 "Time limit per run of a rival's tool. Default: " + format_number(o.timeout, 0),
                 number_between(1, 1e6));
}

void declare(CLI::App& c, RdCommand& a) {
    c.add_option("textures", a.options.textures,
                 "Textures (.tess, .exr, raw with --size, folder of views) or built-in scenes");
    c.add_option("-o,--output", a.options.output,
                 "Folder for index.html, rd.svg, rd-close.svg, rd.csv and rd.json")
        ->required();
    c.add_option(
         "--views", a.views,
         "Measure rendered views of this built-in scene instead of textures: their quality "
         "against the bytes of whole files, for textures on its own surfaces, plain 2D textures "
         "and a sphere. Writes views.svg, .md, .csv and .json")
        ->option_text("SCENE");
    c.add_flag("--json", a.json, "Print JSON");
    declare_measurement(c, a.options);
    add_texture_options(c, a.texture);
}

} // namespace

void add_rd_command(CLI::App& app, Invocation& chosen) {
    add_verb<RdCommand>(
        app, chosen, "rd", "Compare rate, distortion, speed and access with other codecs",
        "Rivals run as their own command-line tools. tools/lab/scripts/install-rivals.sh installs "
        "them from Debian, and the report lists missing ones. Measurements are stored, so after "
        "Ctrl-C the same command continues.\n\n"
        "Examples:\n"
        "  tessera rd scene.tess -o report --quick\n"
        "  tessera rd composed --size 128x64x32x32 -o report\n"
        "  tessera rd views.rgb --size 128x64x32x32 --sphere -o report --rivals x265,avif:mosaic\n"
        "  tessera rd lamps mirror --size 64x64x16x16 -o report --efforts 0,3,4\n"
        "  tessera rd scene.exr -o report --quality 50,62,75,88 --anchor tessera\n"
        "  tessera rd a.png b.png --pictures -o report\n"
        "  tessera rd --views composed -o report",
        declare, run);
}

} // namespace tessera
