#include "tools/support/encode_arguments.h"

#include "tools/support/description_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/option_checks.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/standard_streams.h"

#include <cmath>
#include <utility>

namespace tessera {
namespace {

constexpr std::uint64_t most_target_bytes = std::uint64_t{1} << 50;

RateTarget make_rate(const EncodeArguments& a) {
    using Kind = RateTarget::Kind;
    if (a.target_psnr)
        return {Kind::psnr, *a.target_psnr};
    if (a.target_bpt)
        return {Kind::bpt, *a.target_bpt};
    if (a.target_bytes)
        return {Kind::bytes, static_cast<double>(*a.target_bytes)};
    if (a.max_error)
        return {Kind::max_error, *a.max_error};
    return {Kind::quality, a.quality.value_or(75)};
}

// The options of the rates that were asked for.
std::vector<std::string> given_rates(const EncodeArguments& a) {
    std::vector<std::string> given;
    for (const auto& [option, is_given] : {std::pair("--quality", a.quality.has_value()),
                                           std::pair("--target-psnr", a.target_psnr.has_value()),
                                           std::pair("--target-bpt", a.target_bpt.has_value()),
                                           std::pair("--target-bytes", a.target_bytes.has_value()),
                                           std::pair("--max-error", a.max_error.has_value())})
        if (is_given)
            given.emplace_back(option);
    return given;
}

std::string rate_option(const EncodeArguments& a) {
    const auto given = given_rates(a);
    return given.empty() ? "--quality" : given.front();
}

// Two rates would contradict each other.
Status check_rates(const EncodeArguments& a) {
    const auto given = given_rates(a);
    if (given.size() < 2)
        return {};
    return {ErrorCode::bad_argument,
            given[0] + " and " + given[1] + ": only one of the rates can be asked for"};
}

} // namespace

void add_encode_options(CLI::App& app, EncodeArguments& a) {
    auto* rate = app.add_option_group("Rate", "How many bits, or how much error; at most one");
    rate->add_option("--quality", a.quality,
                     "1..100, 100 is the finest, 8 less doubles the quantiser's steps (default 75)")
        ->check(number_between(1, 100));
    rate->add_option(
            "--target-psnr", a.target_psnr,
            "PSNR in dB over all samples, reached from above; where no quantiser does, the "
            "file is lossless if that is smaller, else exit code 6")
        ->check(number_between(1, 120));
    rate->add_option("--target-bpt", a.target_bpt,
                     "Bits per texel, all channels together, never exceeded")
        ->check(number_between(1e-6, 1000));
    rate->add_option("--target-bytes", a.target_bytes,
                     "Size of the file, such as 20000, 20k or 3M (k = 1024 bytes), never exceeded")
        ->transform(size_between(1, most_target_bytes))
        ->type_name("SIZE");
    rate->add_option("--max-error", a.max_error,
                     "No sample off by more: 8-bit steps, or ulps of half; 0 is lossless")
        ->check(number_between(0, 65535));
    app.add_flag("--lossless-fallback", a.lossless_fallback,
                 "Where no quantiser reaches --target-psnr: a lossless file, even if larger");
    app.add_option("--effort", a.effort,
                   "0 (fastest) to " + std::to_string(most_effort) + " (smallest)")
        ->check(CLI::Range(0, most_effort))
        ->default_str(std::to_string(usual_effort));
    app.add_option("--tools", a.tools)->group(""); // for experiments: tests/regression/ablation.md
    app.add_option(
        "--tile", a.tile,
        "Largest tile UxVxSxT, u and v to 64, s and t to 32, at most 393216 texels, 65536 "
        "with --max-error (what a trial finds smallest: all views of a small place, "
        "32x24x9x9 of 9x9, or fewer of a larger one, 32x32x8x8 or 64x64x4x4 of 32x32; "
        "64x64x9x9 where it shows what cameras see; with --layers 32x32x8x8 or "
        "32x32x4x4)");
    app.add_flag("--layers", a.layers,
                 "Put coarse levels first (at most 3 % more bytes): any beginning of the file then "
                 "shows the whole texture, see decode --allow-partial");
    app.add_flag("--no-verify", a.no_verify, "Do not decode every tile again before it is written");
    app.add_flag("--strict", a.strict, "Refuse NaN and infinities instead of replacing them");
    app.add_flag("--resume", a.resume,
                 "Go on with what an interrupted run left in OUTPUT.journal; same options needed, "
                 "same bytes come out");
    add_memory_option(app, a.memory);
    app.add_flag("--json", a.json, "Print what was achieved as JSON");
    app.add_option("--meta", a.metadata, "key=value to store; may be repeated")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    for (const char* field : description_fields)
        app.add_option_function<std::string>(
               std::string("--") + field,
               [&a, field](const std::string& text) { a.description[field] = text; },
               description_field_values(field))
            ->group("Description");
}

Result<EncodeOptions> make_encode_options(const EncodeArguments& a, unsigned threads,
                                          Metadata metadata, Description description) {
    EncodeOptions options;
    TESSERA_TRY(check_rates(a));
    options.rate = make_rate(a);
    options.rate_name = rate_option(a);
    if (a.lossless_fallback && !a.target_psnr)
        return Status(ErrorCode::bad_argument, "--lossless-fallback: belongs to --target-psnr");
    options.lossless_fallback = a.lossless_fallback;
    options.effort = a.effort.value_or(usual_effort);
    TESSERA_TRY(check_coding_tools(a.tools).with_context("--tools"));
    options.tools = a.tools;
    options.threads = threads;
    TESSERA_TRY_ASSIGN(options.slab_bytes, slab_budget(a.memory, threads));
    options.verify = !a.no_verify;
    options.layers = a.layers;
    options.strict = a.strict;
    options.journal = a.resume ? JournalUse::resume : JournalUse::start;
    options.cancelled = [] { return interrupted_by() != 0; };
    if (!a.tile.empty()) {
        TESSERA_TRY_ASSIGN(options.tile_extent, parse_extent(a.tile).with_context("--tile"));
    }
    for (const std::string& entry : a.metadata) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos || equals == 0)
            return Status(ErrorCode::bad_argument, "--meta: '" + entry + "' is not key=value");
        if (entry.starts_with(made_prefix))
            return Status(ErrorCode::bad_argument,
                          "--meta: '" + entry.substr(0, equals) + "': keys that begin with '" +
                              made_prefix + "' say how the file was encoded and are not yours");
        metadata[entry.substr(0, equals)] = entry.substr(equals + 1);
    }
    for (const auto& [field, text] : a.description)
        TESSERA_TRY(set_description_field(description, field, text).with_context("--" + field));
    options.metadata = std::move(metadata);
    options.description = description;
    return options;
}

Status check_reuse_options(const EncodeArguments& a) {
    std::string given = given_rates(a).empty() ? "" : rate_option(a);
    if (!a.tools.empty())
        given = "--tools";
    if (!a.tile.empty())
        given = "--tile";
    return given.empty()
               ? Status()
               : Status(ErrorCode::bad_argument, given + ": is what it is in the file of --reuse");
}

Status check_tess_output(const EncodeArguments& a, const std::string& output) {
    if (output != standard_stream)
        return check_output_path(output);
    if (a.resume)
        return {ErrorCode::bad_argument, "--resume: what goes to standard output has no journal"};
    TESSERA_TRY(check_json_output(a.json, output));
    return check_standard_output();
}

Status check_for(const EncodeArguments& a, const EncodeOptions& options, const TextureDesc& desc) {
    const auto alpha = a.description.find("alpha");
    if (alpha != a.description.end() && options.description.alpha != AlphaMode::none &&
        desc.channels % 2 != 0)
        return {ErrorCode::bad_argument, "--alpha " + alpha->second +
                                             ": belongs to 2 or 4 channels; the texture has " +
                                             std::to_string(desc.channels)};
    const double largest = desc.type == SampleType::unorm8 ? 255 : 65535;
    if (a.max_error && (*a.max_error > largest || *a.max_error != std::floor(*a.max_error)))
        return {ErrorCode::bad_argument, "--max-error: must be a whole number from 0 to " +
                                             format_number(largest, 0) + " for " +
                                             name_of(desc.type) + " samples"};
    // One option after the other, so that an error names its own.
    EncodeOptions checked = options;
    checked.rate = {};
    checked.tile_extent = tile_by_trial;
    TESSERA_TRY(check_options(desc, checked));
    checked.tile_extent = options.tile_extent;
    TESSERA_TRY(check_options(desc, checked).with_context("--tile"));
    return check_options(desc, options).with_context(rate_option(a));
}

std::string option_of_encoder(const EncodeArguments& a) {
    if (!given_rates(a).empty())
        return rate_option(a);
    for (const auto& [option, is_given] :
         {std::pair("--lossless-fallback", a.lossless_fallback),
          std::pair("--effort", a.effort.has_value()), std::pair("--tools", !a.tools.empty()),
          std::pair("--tile", !a.tile.empty()), std::pair("--layers", a.layers),
          std::pair("--no-verify", a.no_verify), std::pair("--strict", a.strict),
          std::pair("--resume", a.resume), std::pair("--meta", !a.metadata.empty())})
        if (is_given)
            return option;
    return "";
}

Status with_resume_hint(const Status& status, const std::string& output) {
    // What is wrong with the command stays wrong.
    if (status.code() == ErrorCode::bad_argument || !holds_finished_tiles(output))
        return status;
    return {status.code(), status.message() + "; the same command with --resume goes on"};
}

} // namespace tessera
