#include "corpus/bake.h"
#include "tools/lab/rd/rd_run.h"
#include "tools/lab/rd/views_study.h"
#include "tools/support/option_checks.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/verbs/command.h"

#include <sstream>

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
        return {ErrorCode::bad_argument, "--views makes its own textures; it takes no others"};
    if (a.options.efforts.size() > 1)
        return {ErrorCode::bad_argument, "--views: one of --efforts at a time"};
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
        std::printf("\n%s\nLook at %s/views.svg\n", to_text(report).c_str(), o.output.c_str());
    return {};
}

Status run(const RdCommand& a) {
    if (!a.views.empty())
        return run_views(a);
    if (a.options.textures.empty())
        return {ErrorCode::bad_argument, "a texture or --views SCENE is needed"};
    RdOptions options = a.options;
    TESSERA_TRY_ASSIGN(options.hints, make_hints(a.texture));
    options.quiet = a.texture.quiet;
    options.print_lines = !a.texture.quiet && !a.json;
    TESSERA_TRY_ASSIGN(const auto report, run_rd(options));
    if (a.json)
        print_json(to_json(report));
    else if (!a.texture.quiet)
        std::printf("\n%s%s\n", to_text(report).c_str(),
                    ("Look at " + options.output + "/index.html").c_str());
    return {};
}

// Of lines such as "copies: from other views".
std::string names_of_tools() {
    std::istringstream lines(coding_tools_help());
    std::string names;
    for (std::string line; std::getline(lines, line);)
        names += (names.empty() ? "" : ", ") + line.substr(0, line.find(':'));
    return names;
}

void declare_rates(CLI::App& c, RdOptions& o) {
    c.add_option("--psnr", o.psnr, "PSNRs in dB that tessera is measured at (35,38,41,44)")
        ->delimiter(',')
        ->check(CLI::Range(1.0, 200.0));
    c.add_option("--quality", o.quality,
                 "Qualities 1..100 that it is measured at; with --psnr both")
        ->delimiter(',')
        ->check(CLI::Range(1.0, 100.0));
    c.add_option("--efforts", o.efforts,
                 "Efforts 0..4 that it is measured at (3, and a point each at 0 and 4)")
        ->delimiter(',')
        ->check(CLI::Range(0, most_effort));
    c.add_option("--tools", o.tools,
                 "Coding tools off or on, such as -copies,+grids; of " + names_of_tools())
        ->type_name("LIST");
    c.add_option("--rivals", o.rivals,
                 "all, none, or ids with commas: x265, x265:8, x265:medium, aom, svtav1, avif, "
                 "avif:mosaic, jxl, astc, zfp:rate, zfp:accuracy, exr:dwaa, raw (all)");
    c.add_option("--anchor", o.anchor,
                 "The codec that BD-rates are against (x265 if it ran, else tessera)");
}

void declare_sweep(CLI::App& c, RdOptions& o) {
    c.add_flag(
        "--quick", o.quick,
        "A first plot in about a minute: a crop of 64x64x16x16 texels, effort 1, fast rivals");
    c.add_option("--texture-size", o.texture_size, "UxVxSxT of a scene (its own)");
    c.add_option("--samples", o.samples, "Rays per texel of a scene")
        ->check(CLI::Range(1u, corpus::max_samples_per_texel))
        ->capture_default_str();
    c.add_flag("--sphere", o.on_sphere,
               "The texture lies on the scenes' sphere though its file does not say so: measure "
               "rendered views");
    c.add_option("--cache", o.cache, "Folder of measurements, to go on from (OUTPUT/cache)");
    c.add_flag("--keep", o.keep, "Keep the files that codecs read and wrote, in OUTPUT/bitstreams");
    c.add_option("--timeout", o.timeout, "Seconds that a run of a rival's tool may take")
        ->check(number_between(1, 1e6))
        ->capture_default_str();
}

} // namespace

void add_rd_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, RdCommand& a) {
        c.add_option("textures", a.options.textures,
                     "Textures: .tess, .exr, raw (with --size), folder of views; or scenes");
        c.add_option("--views", a.views,
                     "Instead: what an observer sees of this built-in scene over the bytes of "
                     "whole files: on its own surfaces, with a plain 2D texture, on the paper's "
                     "sphere; writes views.svg, .md, .csv and .json");
        c.add_option(
             "-o,--output", a.options.output,
             "Folder for index.html, rd.svg, rd-close.svg, rd.csv and rd.json (made if missing)")
            ->required();
        declare_rates(c, a.options);
        declare_sweep(c, a.options);
        c.add_flag("--json", a.json, "Print JSON");
        add_texture_options(c, a.texture);
    };
    add_verb<RdCommand>(
        app, chosen, "rd", "Measure rate, distortion, speed and access beside other codecs",
        "Rivals run through their own command-line tools; tools/lab/scripts/install-rivals.sh "
        "installs "
        "them\n"
        "from Debian, and what is missing is named. Results are kept: after Ctrl-C the same\n"
        "command goes on where it stopped.\n\n"
        "Examples:\n"
        "  tessera rd scene.tess -o report --quick\n"
        "  tessera rd composed --texture-size 128x64x32x32 -o report\n"
        "  tessera rd views.rgb --size 128x64x32x32 --sphere -o report --rivals x265,avif:mosaic\n"
        "  tessera rd lamps mirror --texture-size 64x64x16x16 -o report --efforts 0,3,4\n"
        "  tessera rd scene.exr -o report --quality 50,62,75,88 --anchor tessera\n"
        "  tessera rd --views composed -o report",
        declare, run);
}

} // namespace tessera
