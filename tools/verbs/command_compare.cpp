#include "codec/decoder.h"
#include "codec/metrics.h"
#include "corpus/bake.h"
#include "tools/http/open_bytes.h"
#include "tools/scenes/baked_original.h"
#include "tools/scenes/scene_name.h"
#include "tools/support/fill_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/json_text.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/support/warnings.h"
#include "tools/texture_io/mask_io.h"
#include "tools/texture_io/texture_io.h"
#include "tools/verbs/command.h"
#include "tools/verbs/compare_photographs.h"
#include "tools/verbs/prefix_curve.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

namespace tessera {
namespace {

struct CompareCommand {
    std::string a, b;
    TextureArguments texture;
    MaskArguments mask;
    std::optional<double> min_psnr, max_error, min_ssim, sample;
    std::uint64_t sample_seed = 1;
    std::string scene, memory; // scene: baked again as the reference
    std::optional<unsigned> samples;
    std::optional<std::uint64_t> seed;
    bool no_ssim = false, json = false, strict = false;
    std::optional<unsigned> beginnings;
    bool pictures = false; // a and b are folders of pictures
    std::string background, images;
};

struct Inputs {
    std::unique_ptr<TexelSource> a, b;
    std::vector<const Decoder*> decoders{}; // of the inputs that are .tess files
};

// The hints for the inputs, within the memory budget.
Result<TextureHints> hints_within_budget(const CompareCommand& a, Warnings& warnings) {
    TESSERA_TRY_ASSIGN(TextureHints hints, make_hints(a.texture));
    TESSERA_TRY_ASSIGN(const auto slab_bytes, slab_budget(a.memory, a.texture.threads));
    hints.decode = within_budget(hints.decode, slab_bytes, 2);
    hints.warnings = &warnings;
    return hints;
}

// The scene, which is baked while it is read, and the only file.
Result<Inputs> open_baked(const CompareCommand& arguments, Warnings& warnings) {
    TESSERA_TRY_ASSIGN(const auto hints, hints_within_budget(arguments, warnings));
    TESSERA_TRY(check_scene(arguments.scene).with_context("--bake"));
    auto file = open_texture(arguments.a, hints);
    if (!file.ok())
        return with_partial_hint(with_memory_hint(file.status()), arguments.a, hints.decode);
    TESSERA_TRY_ASSIGN(auto baked,
                       bake_again({arguments.scene, arguments.samples, arguments.seed}, arguments.a,
                                  file->source->desc().size, file->description, file->metadata));
    std::vector<const Decoder*> decoders;
    if (file->decoder != nullptr)
        decoders.push_back(file->decoder);
    return Inputs{interruptible(std::move(baked)), interruptible(std::move(file->source)),
                  decoders};
}

Result<Inputs> open_both(const CompareCommand& arguments, Warnings& warnings) {
    TESSERA_TRY_ASSIGN(const auto hints, hints_within_budget(arguments, warnings));
    auto opened = open_two_textures(arguments.a, arguments.b, hints);
    if (!opened.ok())
        return with_partial_hint(with_memory_hint(opened.status()), arguments.a, arguments.b,
                                 hints.decode);
    auto& [first, second] = *opened;
    std::vector<const Decoder*> decoders;
    for (const Decoder* decoder : {first.decoder, second.decoder})
        if (decoder != nullptr)
            decoders.push_back(decoder);
    return Inputs{interruptible(std::move(first.source)), interruptible(std::move(second.source)),
                  decoders};
}

// The missed thresholds, each with the measured value.
std::vector<std::string> missed_thresholds(const CompareCommand& a, const Comparison& c) {
    std::vector<std::string> missed;
    if (a.min_psnr && c.errors.psnr() < *a.min_psnr)
        missed.push_back("PSNR " + format_number(c.errors.psnr(), 4) + " dB is below " +
                         format_number(*a.min_psnr, 4));
    if (a.max_error && c.errors.max_error() > *a.max_error)
        missed.push_back("the largest error " + std::to_string(c.errors.max_error()) +
                         " is above " + format_number(*a.max_error, 0));
    if (a.min_ssim && c.ssim_mean < *a.min_ssim)
        missed.push_back("SSIM " + format_number(c.ssim_mean, 6) + " is below " +
                         format_number(*a.min_ssim, 6));
    return missed;
}

// null if the textures are identical, since JSON has no infinity.
Json decibels_or_null(double db) {
    return std::isfinite(db) ? Json(db) : Json(nullptr);
}

std::string first_name(const CompareCommand& a) {
    return a.scene.empty() ? a.a : a.scene + " (baked)";
}
std::string second_name(const CompareCommand& a) {
    return a.scene.empty() ? a.b : a.a;
}

Json to_json(const CompareCommand& a, const TextureDesc& desc, const Comparison& c,
             const std::vector<std::string>& missed, const Warnings& warnings, double seconds) {
    const ErrorSums& e = c.errors;
    Json json = {{"a", first_name(a)},
                 {"b", second_name(a)},
                 {"size", to_string(desc.size)},
                 {"type", name_of(desc.type)},
                 {"channels", desc.channels},
                 {"identical", e.differing_samples() == 0},
                 {"differing_samples", e.differing_samples()},
                 {"psnr", decibels_or_null(e.psnr())}};
    for (unsigned i = 0; i < desc.channels; ++i)
        json["psnr_per_channel"][channel_name(desc.channels, i)] = decibels_or_null(e.psnr(i));
    if (!traits_of(desc.type).is_float) {
        json["psnr_luma"] = decibels_or_null(e.psnr_luma());
    } else {
        json["psnr_pu21"] = decibels_or_null(e.psnr_pu21());
        json["psnr_log2"] = decibels_or_null(e.psnr_log2());
        json["non_finite_a"] = e.non_finite(0);
        json["non_finite_b"] = e.non_finite(1);
    }
    const SamplePlace& p = e.max_error_place();
    json["max_error"] = e.max_error();
    json["max_error_at"] = {{"u", p.u}, {"v", p.v}, {"s", p.s}, {"t", p.t}, {"channel", p.channel}};
    if (c.has_ssim)
        json["ssim"] = {{"mean", c.ssim_mean},
                        {"worst", c.ssim_worst},
                        {"worst_view", {{"s", c.worst_s}, {"t", c.worst_t}}},
                        {"views", c.views}};
    if (c.tiles > 0)
        json["sample"] = {{"tiles", c.compared_tiles},
                          {"of_tiles", c.tiles},
                          {"texels", e.texels()},
                          {"seed", a.sample_seed}};
    if (!a.mask.path.empty())
        json["mask"] = {{"file", a.mask.path}, {"texels", e.texels()}};
    json["seconds"] = seconds;
    json["passed"] = missed.empty();
    json["missed"] = missed;
    json["warnings"] = warnings.json();
    return json;
}

std::string decibel_text(double db) {
    return std::isfinite(db) ? format_number(db, 2) + " dB" : "no error";
}

void print_text(const CompareCommand& a, const TextureDesc& desc, const Comparison& c,
                double seconds) {
    const ErrorSums& e = c.errors;
    const bool hdr = traits_of(desc.type).is_float;
    std::printf("%s, %d x %s\n", to_string(desc.size).c_str(), desc.channels, name_of(desc.type));
    std::printf("  PSNR        %s%s", decibel_text(e.psnr()).c_str(),
                hdr ? " over 16-bit codes" : "");
    for (unsigned i = 0; i < desc.channels; ++i)
        std::printf("%s%s %s", i == 0 ? "   (" : ", ", channel_name(desc.channels, i),
                    decibel_text(e.psnr(i)).c_str());
    std::printf(")\n");
    if (hdr) {
        std::printf("  PU21-PSNR   %s (1.0 = 100 cd/m2)\n", decibel_text(e.psnr_pu21()).c_str());
        std::printf("  log2-PSNR   %s (floor 1e-4, peak 29.3 stops)\n",
                    decibel_text(e.psnr_log2()).c_str());
        if (e.non_finite(0) + e.non_finite(1) > 0)
            std::printf("  not finite  %llu and %llu samples\n",
                        static_cast<unsigned long long>(e.non_finite(0)),
                        static_cast<unsigned long long>(e.non_finite(1)));
    } else {
        std::printf("  luma PSNR   %s\n", decibel_text(e.psnr_luma()).c_str());
    }
    if (c.tiles > 0)
        std::printf("  sample      %llu of %llu tiles, %llu texels\n",
                    static_cast<unsigned long long>(c.compared_tiles),
                    static_cast<unsigned long long>(c.tiles),
                    static_cast<unsigned long long>(e.texels()));
    if (!a.mask.path.empty())
        std::printf("  mask        %llu texels are not masked, and only they count; no SSIM\n",
                    static_cast<unsigned long long>(e.texels()));
    const SamplePlace& p = e.max_error_place();
    std::printf("  max error   %u %s", e.max_error(), hdr ? "ulps" : "steps");
    if (e.max_error() > 0)
        std::printf(" at u %u, v %u, s %u, t %u, channel %s", p.u, p.v, p.s, p.t,
                    channel_name(desc.channels, p.channel));
    std::printf("\n");
    if (c.has_ssim)
        std::printf("  SSIM        %.5f over %llu views, worst %.5f at s %u, t %u\n", c.ssim_mean,
                    static_cast<unsigned long long>(c.views), c.ssim_worst, c.worst_s, c.worst_t);
    std::printf("  time        %.2f s\n", seconds);
}

// A slab may be in memory twice and, for SSIM, as two planes of floats. Opens `mask`, which must
// outlive the options. Errors: bad_argument (--memory), those of open_mask.
Result<CompareOptions> compare_options(const CompareCommand& a, const TextureDesc& desc,
                                       Progress& progress, std::unique_ptr<TexelSource>& mask) {
    TESSERA_TRY_ASSIGN(auto memory, slab_budget(a.memory, a.texture.threads));
    auto opened = open_mask(a.mask, desc.size, a.texture.threads, memory);
    if (!opened.ok())
        return with_memory_hint(opened.status());
    mask = std::move(*opened);
    CompareOptions options;
    options.mask = mask.get();
    options.with_ssim = !a.no_ssim && !a.beginnings;
    options.threads = a.texture.threads;
    options.progress = progress.function();
    const std::uint64_t held = 2 + 8 / desc.texel_bytes() + 1;
    options.slab_bytes = std::min(options.slab_bytes, memory / held);
    return options;
}

// The reference of --beginnings. A raw one has the size of the measured file.
Result<std::unique_ptr<TexelSource>> open_reference(const CompareCommand& a, ByteSource& measured,
                                                    Warnings& warnings) {
    TESSERA_TRY_ASSIGN(auto hints, hints_within_budget(a, warnings));
    const auto reader =
        ContainerReader::open(measured, {.most_head_bytes = hints.decode.most_head_bytes});
    if (!reader.ok())
        return with_memory_hint(reader.status());
    if (!hints.size && kind_of_input(a.a) == TextureKind::raw)
        hints.size = reader->desc().size;
    TESSERA_TRY_ASSIGN(auto opened, open_texture(a.a, hints));
    return interruptible(std::move(opened.source));
}

Status run_photographs(const CompareCommand& a) {
    if (a.b.empty() || !a.scene.empty() || a.max_error || a.sample || a.beginnings ||
        !a.mask.path.empty())
        return {ErrorCode::bad_argument,
                "photographs are compared with a folder of pictures, without --bake, --max-error, "
                "--sample, --beginnings and --mask"};
    return compare_photographs({.photographs = a.a,
                                .images = a.images,
                                .drawn = a.b,
                                .background = a.background,
                                .min_psnr = a.min_psnr,
                                .min_ssim = a.min_ssim,
                                .threads = a.texture.threads,
                                .quiet = a.texture.quiet,
                                .json = a.json,
                                .strict = a.strict});
}

// Measures the second texture at beginnings of its file.
Status run_beginnings(const CompareCommand& a) {
    if (!a.scene.empty() || a.b.empty() || kind_of_input(a.b) != TextureKind::tess)
        return {ErrorCode::bad_argument, "--beginnings needs a reference and a .tess file"};
    TESSERA_TRY_ASSIGN(const auto file, open_bytes(a.b));
    Warnings warnings(a.strict);
    TESSERA_TRY_ASSIGN(const auto reference, open_reference(a, *file, warnings));
    Result<std::vector<PrefixPoint>> points = Status();
    {
        Progress progress("tessera compare", a.texture.quiet || a.json);
        std::unique_ptr<TexelSource> mask;
        TESSERA_TRY_ASSIGN(const auto options,
                           compare_options(a, reference->desc(), progress, mask));
        points = prefix_curve(*reference, *file, *a.beginnings, options);
    }
    TESSERA_TRY(points);
    warnings.print("compare");
    if (a.json) {
        Json json = {
            {"a", a.a}, {"b", a.b}, {"beginnings", Json::array()}, {"warnings", warnings.json()}};
        for (const PrefixPoint& p : *points)
            json["beginnings"].push_back({{"bytes", p.bytes},
                                          {"psnr", decibels_or_null(p.psnr)},
                                          {"missing_tiles", p.missing_tiles},
                                          {"tiles", p.tiles}});
        print_json(json);
    } else if (!a.texture.quiet) {
        print_points(*points);
    }
    return {};
}

Status run(const CompareCommand& a) {
    if (a.pictures || are_photographs(a.a, a.b))
        return run_photographs(a);
    if (!a.background.empty() || !a.images.empty())
        return {ErrorCode::bad_argument,
                "--background and --images can only be used with photographs"};
    if (a.beginnings)
        return run_beginnings(a);
    const auto start = std::chrono::steady_clock::now();
    if (a.scene.empty() == a.b.empty())
        return {ErrorCode::bad_argument, "needs two textures, or one and --bake SCENE"};
    Warnings warnings(a.strict);
    TESSERA_TRY_ASSIGN(const auto inputs,
                       a.scene.empty() ? open_both(a, warnings) : open_baked(a, warnings));
    Result<Comparison> comparison = Status();
    {
        Progress progress("tessera compare", a.texture.quiet);
        std::unique_ptr<TexelSource> mask;
        TESSERA_TRY_ASSIGN(const auto options,
                           compare_options(a, inputs.a->desc(), progress, mask));
        comparison = a.sample
                         ? compare_sample(*inputs.a, *inputs.b, *a.sample, a.sample_seed, options)
                         : compare_textures(*inputs.a, *inputs.b, options);
    }
    TESSERA_TRY(comparison);
    if (a.min_ssim && !comparison->has_ssim)
        return {ErrorCode::unsupported, a.sample ? "--min-ssim: there is no SSIM with --sample"
                                                 : "--min-ssim: the views are too large for SSIM"};
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    const TextureDesc& desc = inputs.a->desc();
    const auto missed = missed_thresholds(a, *comparison);
    warnings.print("compare");
    if (a.json) {
        Json json = to_json(a, desc, *comparison, missed, warnings, seconds.count());
        for (const Decoder* decoder : inputs.decoders)
            if (a.texture.decode.allow_partial || a.texture.decode.allow_damaged)
                json["filled"].push_back(fill_json(*decoder));
        print_json(json);
    } else if (!a.texture.quiet) {
        print_text(a, desc, *comparison, seconds.count());
        for (const Decoder* decoder : inputs.decoders)
            std::fputs(fill_text(*decoder, "  ").c_str(), stdout);
    }
    if (missed.empty())
        return {};
    std::string text = second_name(a) + ": ";
    for (std::size_t i = 0; i < missed.size(); ++i)
        text += (i > 0 ? "; " : "") + missed[i];
    return {ErrorCode::difference, text};
}

void declare_scene(CLI::App& c, CompareCommand& a) {
    OptionGroup group(c, "Comparing with a built-in scene");
    group.option("--bake", "SCENE", a.scene, "Bake this scene as the reference, while it is read");
    group.option("--spp", "N", a.samples, "Rays per texel. Default: as the file says",
                 CLI::Range(1u, corpus::max_samples_per_texel));
    group.option("--seed", "N", a.seed, "Seed of the sample pattern. Default: as the file says");
}

void declare(CLI::App& c, CompareCommand& a) {
    c.add_option("a", a.a, "The reference: .tess or its URL, .exr, raw, folder/, PNG, or -")
        ->required();
    c.add_option("b", a.b, "What is compared with it");
    c.add_option("--min-psnr", a.min_psnr, "Exit with 7 if the PSNR over all samples is lower")
        ->option_text("DB");
    c.add_option("--max-error", a.max_error,
                 "Exit with 7 if a sample differs by more: in 8-bit steps or ulps of half")
        ->option_text("N");
    auto* ssim = c.add_option("--min-ssim", a.min_ssim, "Exit with 7 if the mean SSIM is lower")
                     ->option_text("0..1");
    c.add_flag("--no-ssim", a.no_ssim, "Do not compute SSIM")->excludes(ssim)->option_text(" ");
    add_memory_option(c, a.memory);
    c.add_flag("--json", a.json, "Print JSON");
    c.add_flag("--strict", a.strict, "Make warnings about pictures and photographs errors");
    add_fill_options(c, a.texture.decode);
    constexpr const char* parts_heading = "Comparing parts";
    OptionGroup parts(c, parts_heading);
    auto* sample = parts.option("--sample", "0..1", a.sample,
                                "Compare only this share of the tiles, chosen at random; no SSIM",
                                CLI::Range(0.0, 1.0));
    parts.option("--sample-seed", "N", a.sample_seed, "Seed of that choice. Default: 1")
        ->needs(sample);
    parts
        .option("--beginnings", "N", a.beginnings,
                "PSNR of this many beginnings of b, a .tess: how it looks while it arrives",
                CLI::Range(2u, 1000u))
        ->excludes(ssim)
        ->excludes(sample);
    add_mask_options(c, a.mask, "masked texels are ignored, and there is no SSIM");
    c.get_option("--mask")->excludes(ssim)->option_text("FILE")->group(parts_heading);
    c.get_option("--mask-size")->option_text("UxVxSxT")->group(parts_heading);
    declare_scene(c, a);
    OptionGroup photographs(c, "Comparing photographs");
    photographs.flag("--pictures", a.pictures,
                     "a and b are folders of pictures, which are compared by name. Not needed "
                     "where a is a transforms.json or a COLMAP model");
    photographs.option("--images", "FOLDER", a.images,
                       "Where the photographs of the description a are, if not where it says");
    photographs.option("--background", "COLOUR", a.background,
                       "Behind photographs with alpha: white, black (default) or R,G,B in 0..1");
    add_texture_options(c, a.texture);
    add_network_options(c);
}

} // namespace

void add_compare_command(CLI::App& app, Invocation& chosen) {
    add_verb<CompareCommand>(
        app, chosen, "compare", "Measure the difference between two textures",
        "PSNR and SSIM of 8-bit samples refer to their values, those of half floats to 16-bit "
        "codes. A raw texture takes its size from the other one. Without a threshold the exit code"
        " is 0 for any difference; it is 7 if a threshold is missed, or if size or type differ.\n\n"
        "Examples:\n"
        "  tessera compare scene.exr scene.tess --min-psnr 40\n"
        "  tessera compare scene.rgb scene.tess --json\n"
        "  tessera compare scene.rgb layered.tess --beginnings 12\n"
        "  tessera compare atlas.exr atlas.tess --mask charts.gray --mask-size 512x256x1x1\n"
        "  tessera compare composed.tess --bake composed --sample 0.01\n"
        "  tessera compare suzi/transforms_test.json drawn/ --min-psnr 30",
        declare, run);
}

} // namespace tessera
