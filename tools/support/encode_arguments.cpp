#include "tools/support/encode_arguments.h"

#include "tools/support/description_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/memory_budget.h"
#include "tools/support/parse.h"

#include <algorithm>
#include <cstdio>

namespace tessera {
namespace {

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

} // namespace

void add_encode_options(CLI::App& app, EncodeArguments& a) {
    auto* rate = app.add_option_group("Rate", "How many bits, or how much error; at most one");
    rate->add_option("--quality", a.quality, "1..100, 100 is the finest (default 75)")
        ->check(CLI::Range(1.0, 100.0));
    rate->add_option("--target-psnr", a.target_psnr, "PSNR in dB over all samples")
        ->check(CLI::Range(1.0, 200.0));
    rate->add_option("--target-bpt", a.target_bpt, "Bits per texel, never exceeded")
        ->check(CLI::PositiveNumber);
    rate->add_option("--target-bytes", a.target_bytes, "Bytes of the file, never exceeded")
        ->check(CLI::PositiveNumber);
    rate->add_option("--max-error", a.max_error,
                     "No sample off by more: 8-bit steps, or ulps of half; 0 is lossless")
        ->check(CLI::Range(0.0, 65535.0));
    rate->require_option(0, 1);
    app.add_option("--effort", a.effort, "0 (fastest) to 5 (smallest)")
        ->check(CLI::Range(0, most_effort))
        ->capture_default_str();
    app.add_option("--tools", a.tools)->group(""); // for experiments: tests/regression/ablation.md
    app.add_option("--tile", a.tile, "Largest tile UxVxSxT, u and v to 64, s and t to 32 (32x32x8x8, or 64x64x4x4 "
                   "where a trial finds it smaller; with --layers 32x32x4x4 in place of the latter)");
    app.add_flag("--layers", a.layers,
                 "Put coarse levels first (at most 3 % more bytes): any beginning of the file then "
                 "shows the whole texture, see decode --allow-partial");
    app.add_flag("--no-verify", a.no_verify, "Do not decode every tile again before it is written");
    app.add_flag("--strict", a.strict, "Refuse NaN and infinities instead of replacing them");
    app.add_flag("--resume", a.resume,
                 "Go on with what an interrupted run left in OUTPUT.journal; same options needed, "
                 "same bytes come out");
    add_memory_option(app, a.memory);
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
    options.rate = make_rate(a);
    options.effort = a.effort;
    TESSERA_TRY(check_coding_tools(a.tools).with_context("--tools"));
    options.tools = a.tools;
    options.threads = threads;
    const auto slab_bytes = slab_budget(a.memory, threads);
    if (!slab_bytes.ok())
        return slab_bytes.status();
    options.slab_bytes = *slab_bytes;
    options.verify = !a.no_verify;
    options.layers = a.layers;
    options.strict = a.strict;
    options.journal = a.resume ? JournalUse::resume : JournalUse::start;
    options.cancelled = [] { return interrupted_by() != 0; };
    if (!a.tile.empty()) {
        const auto tile = parse_extent(a.tile);
        if (!tile.ok())
            return tile.status().with_context("--tile");
        options.tile_extent = *tile;
    }
    for (const std::string& entry : a.metadata) {
        const std::size_t equals = entry.find('=');
        if (equals == std::string::npos || equals == 0)
            return Status(ErrorCode::bad_argument, "--meta: '" + entry + "' is not key=value");
        metadata[entry.substr(0, equals)] = entry.substr(equals + 1);
    }
    for (const auto& [field, text] : a.description)
        TESSERA_TRY(set_description_field(description, field, text).with_context("--" + field));
    options.metadata = std::move(metadata);
    options.description = description;
    return options;
}

bool says_how_to_encode(const EncodeArguments& a) {
    return a.quality || a.target_psnr || a.target_bpt || a.target_bytes || a.max_error ||
           a.resume || a.layers || !a.tile.empty() || !a.tools.empty() || !a.metadata.empty();
}

Status with_resume_hint(const Status& status, const std::string& output) {
    const bool kept = status.message().find("kept in " + journal_path(output)) != std::string::npos;
    return kept ? Status(status.code(),
                         status.message() + "; the same command with --resume goes on")
                : status;
}

void print_report(const std::string& path, const TextureDesc& desc, const EncodeReport& r) {
    const double ratio = static_cast<double>(r.raw_bytes) /
                         static_cast<double>(std::max<std::uint64_t>(1, r.file_bytes));
    const double speed = static_cast<double>(r.raw_bytes) / 1e6 / std::max(r.seconds, 1e-9);
    std::printf("%s: %s, %d x %s\n", path.c_str(), to_string(desc.size).c_str(), desc.channels,
                name_of(desc.type));
    std::printf("  size   %llu bytes (%s of %s), ratio %.1f, %.4f bits per texel\n",
                static_cast<unsigned long long>(r.file_bytes), human_bytes(r.file_bytes).c_str(),
                human_bytes(r.raw_bytes).c_str(), ratio, r.bits_per_texel);
    if (r.texels_that_matter)
        std::printf("  mask   %.2f %% of the texels matter; PSNR and error are theirs\n",
                    100.0 * static_cast<double>(*r.texels_that_matter) /
                        static_cast<double>(texel_count(desc.size)));
    const std::string psnr = r.psnr >= 999 ? "lossless" : format_number(r.psnr, 2) + " dB";
    std::printf("  PSNR   %s%s, largest error %.0f\n", psnr.c_str(),
                desc.type == SampleType::half16 && r.psnr < 999 ? " (over 16-bit codes)" : "",
                r.max_error);
    std::printf("  time   %.2f s, %.1f MB/s, %u pass%s\n", r.seconds, speed, r.passes,
                r.passes == 1 ? "" : "es");
    for (const CodedLevel& level : r.coarse_levels)
        std::printf("  level  %s in %llu bytes (%.2f %%), steps x%u\n",
                    to_string(level.size).c_str(), static_cast<unsigned long long>(level.bytes),
                    100.0 * static_cast<double>(level.bytes) / static_cast<double>(r.file_bytes),
                    1u << level.step_shift);
    if (r.nan_count + r.infinity_count > 0)
        std::printf("  note   %llu NaN replaced by 0, %llu infinities by +-65504\n",
                    static_cast<unsigned long long>(r.nan_count),
                    static_cast<unsigned long long>(r.infinity_count));
    if (!r.note.empty())
        std::printf("  note   %s\n", r.note.c_str());
}

} // namespace tessera
