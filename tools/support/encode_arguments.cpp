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
constexpr double usual_quality = 75;

RateTarget make_rate(const EncodeArguments& a) {
    using Kind = RateTarget::Kind;
    if (a.target_psnr)
        return {Kind::psnr, *a.target_psnr};
    if (a.target_bpt)
        return {Kind::bpt, *a.target_bpt};
    if (a.target_bytes)
        return {Kind::bytes, static_cast<double>(*a.target_bytes)};
    if (a.lossless)
        return {Kind::max_error, 0};
    if (a.max_error)
        return {Kind::max_error, *a.max_error};
    return {Kind::quality, a.quality.value_or(usual_quality)};
}

// The rate options on the command line.
std::vector<std::string> given_rates(const EncodeArguments& a) {
    std::vector<std::string> given;
    for (const auto& [option, is_given] :
         {std::pair("--quality", a.quality.has_value()),
          std::pair("--target-psnr", a.target_psnr.has_value()),
          std::pair("--target-bpt", a.target_bpt.has_value()),
          std::pair("--target-bytes", a.target_bytes.has_value()),
          std::pair("--max-error", a.max_error.has_value()), std::pair("--lossless", a.lossless)})
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
    return {ErrorCode::bad_argument, given[0] + " and " + given[1] + ": only one rate is possible"};
}

Status add_metadata(const std::vector<std::string>& entries, Metadata& metadata) {
    for (const std::string& entry : entries) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos || equals == 0)
            return {ErrorCode::bad_argument, "--meta: '" + entry + "' is not key=value"};
        if (entry.starts_with(made_prefix))
            return {ErrorCode::bad_argument, "--meta: '" + entry.substr(0, equals) +
                                                 "': keys that begin with '" + made_prefix +
                                                 "' are reserved for the encoder"};
        metadata[entry.substr(0, equals)] = entry.substr(equals + 1);
    }
    return {};
}

} // namespace

void add_rate_options(CLI::App& app, EncodeArguments& a) {
    OptionGroup group(app, "Rate (at most one) and effort");
    group.option("--quality", "1..100", a.quality,
                 "100 is the finest; 8 less doubles the quantiser's step. Default: 75",
                 number_between(1, 100));
    group.option("--target-psnr", "DB", a.target_psnr,
                 "Least PSNR over all samples. If no quantiser reaches it, the file is lossless if "
                 "that is smaller; else the exit code is 6",
                 number_between(1, 120));
    group.option("--target-bpt", "BITS", a.target_bpt, "Most bits per texel, all channels together",
                 number_between(1e-6, 1000));
    group
        .option("--target-bytes", "SIZE", a.target_bytes,
                "Most bytes of the file, such as 20000, 20k or 3M")
        ->transform(size_between(1, most_target_bytes));
    group.option("--max-error", "N", a.max_error,
                 "Largest error, in steps of 8-bit samples or in ulps of half floats",
                 number_between(0, 65535));
    group.flag("--lossless", a.lossless, "The same as --max-error 0");
    group.flag("--lossless-fallback", a.lossless_fallback,
               "Write a lossless file if no quantiser reaches --target-psnr");
    group.option("--effort", "0.." + std::to_string(most_effort), a.effort,
                 "0 is the fastest, " + std::to_string(most_effort) +
                     " gives the smallest file. Default: " + std::to_string(usual_effort),
                 CLI::Range(0, most_effort));
}

void add_run_options(CLI::App& app, EncodeArguments& a) {
    app.add_flag("--resume", a.resume, "Continue an interrupted run, which left OUTPUT.journal");
    add_memory_option(app, a.memory);
    app.add_flag("--json", a.json, "Print the result as JSON");
}

void add_layout_options(CLI::App& app, EncodeArguments& a) {
    OptionGroup group(app, layout_heading);
    group.flag("--layers", a.layers,
               "Store coarse levels first (at most 3 % larger), so that any beginning of the file "
               "shows the whole texture (decode --allow-partial)");
    group.option(
        "--tile", "UxVxSxT", a.tile,
        "Largest tile: u, v up to 256, s, t up to 32, at most 393216 texels, or 65536 with "
        "--max-error. Default: the encoder tries several");
    group.flag("--no-verify", a.no_verify, "Do not decode each tile again for a comparison");
    group.flag("--strict", a.strict,
               "Make warnings errors: NaN and infinities, and what a picture or a model states and "
               "Tessera does not follow");
}

void add_description_options(CLI::App& app, EncodeArguments& a) {
    OptionGroup group(app, description_heading);
    for (const char* field : description_fields)
        app.add_option_function<std::string>(
               std::string("--") + field,
               [&a, field](const std::string& text) { a.description[field] = text; },
               description_field_values(field))
            ->option_text(" ")
            ->group(description_heading);
    group.option("--meta", "KEY=VALUE", a.metadata, "Text to store under a key; may be repeated")
        ->allow_extra_args(false);
}

Result<EncodeOptions> make_encode_options(const EncodeArguments& a, unsigned threads,
                                          Metadata metadata, Description description) {
    EncodeOptions options;
    TESSERA_TRY(check_rates(a));
    options.rate = make_rate(a);
    options.labels.rate = rate_option(a);
    if (a.lossless_fallback && !a.target_psnr)
        return Status(ErrorCode::bad_argument, "--lossless-fallback: belongs to --target-psnr");
    options.lossless_fallback = a.lossless_fallback;
    options.effort = a.effort.value_or(usual_effort);
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
    TESSERA_TRY(add_metadata(a.metadata, metadata));
    for (const auto& [field, text] : a.description)
        if (field == "proxy" && text == "mesh")
            description.proxy = Proxy::mesh;
        else
            TESSERA_TRY(set_description_field(description, field, text).with_context("--" + field));
    options.metadata = std::move(metadata);
    options.description = description;
    return options;
}

Status check_reuse_options(const EncodeArguments& a) {
    const std::string given = !a.tile.empty()           ? "--tile"
                              : !given_rates(a).empty() ? rate_option(a)
                                                        : "";
    if (given.empty())
        return {};
    return {ErrorCode::bad_argument, given + ": the file of --reuse determines it"};
}

Status check_tess_output(const EncodeArguments& a, const std::string& output) {
    if (is_glb_name(output))
        return {ErrorCode::bad_argument,
                output + ": is written by tessera convert, from a .tess, and by bake"};
    if (output != standard_stream) {
        if (is_being_encoded(output))
            return {ErrorCode::io, output + ": another process is writing this output now"};
        return check_output_path(output);
    }
    if (a.resume)
        return {ErrorCode::bad_argument, "--resume: standard output has no journal"};
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
    const double largest = traits_of(desc.type).largest_error;
    if (a.max_error && (*a.max_error > largest || *a.max_error != std::floor(*a.max_error)))
        return {ErrorCode::bad_argument, "--max-error: must be a whole number from 0 to " +
                                             format_number(largest, 0) + " for " +
                                             name_of(desc.type) + " samples"};
    // Checks one option at a time, so that an error names the right one.
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
          std::pair("--effort", a.effort.has_value()), std::pair("--tile", !a.tile.empty()),
          std::pair("--layers", a.layers), std::pair("--no-verify", a.no_verify),
          std::pair("--strict", a.strict), std::pair("--resume", a.resume),
          std::pair("--meta", !a.metadata.empty())})
        if (is_given)
            return option;
    return "";
}

Status with_resume_hint(const Status& status, const std::string& output) {
    // A wrong command stays wrong.
    if (status.code() == ErrorCode::bad_argument || !holds_finished_tiles(output))
        return status;
    return {status.code(), status.message() + "; the same command with --resume continues"};
}

} // namespace tessera
