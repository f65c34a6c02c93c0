#include "tools/support/encode_report.h"

#include "tools/support/encode_arguments.h"
#include "tools/support/output_folders.h"
#include "tools/support/parse.h"
#include "tools/support/standard_streams.h"

#include <algorithm>

namespace tessera {
namespace {

const char* name_of(RateTarget::Kind kind) {
    using Kind = RateTarget::Kind;
    switch (kind) {
    case Kind::quality:
        return "quality";
    case Kind::psnr:
        return "psnr";
    case Kind::bpt:
        return "bpt";
    case Kind::bytes:
        return "bytes";
    case Kind::max_error:
        return "max-error";
    }
    return "?";
}

Result<EncodeReport> encode_to_standard_output(TexelSource& source, const EncodeOptions& options) {
    auto report = encode_stream(source, write_standard_output, options);
    if (report.ok())
        TESSERA_TRY(flush_standard_output());
    return report;
}

} // namespace

Result<EncodeReport> encode_to(TexelSource& source, const std::string& path,
                               const EncodeOptions& options) {
    if (path == standard_stream)
        return encode_to_standard_output(source, options);
    TESSERA_TRY(make_parent_folders(path));
    auto report = encode_file(source, path, options);
    return report.ok() ? std::move(report) : with_resume_hint(report.status(), path);
}

Status check_target(const std::string& path, const EncodeOptions& options, const EncodeReport& r) {
    if (r.target_met)
        return {};
    return {ErrorCode::target_missed, path + ": has " + format_number(r.psnr, 2) + " dB, not " +
                                          format_number(options.rate.value, 2) + ": " + r.note +
                                          "; --lossless-fallback writes a lossless file"};
}

void count_replaced(const EncodeReport& report, Warnings& warnings) {
    // A strict command has failed at the first one, while it encoded.
    (void)warnings.add("NaN became 0", "", report.nan_count);
    (void)warnings.add("infinities became +-65504", "", report.infinity_count);
}

void print_report(std::FILE* to, const std::string& path, const TextureDesc& desc,
                  const EncodeReport& r) {
    const double ratio = static_cast<double>(r.raw_bytes) /
                         static_cast<double>(std::max<std::uint64_t>(1, r.file_bytes));
    const double speed = static_cast<double>(r.raw_bytes) / 1e6 / std::max(r.seconds, 1e-9);
    std::fprintf(to, "%s: %s, %d x %s\n", path.c_str(), to_string(desc.size).c_str(), desc.channels,
                 name_of(desc.type));
    std::fprintf(to, "  size   %llu bytes (%s of %s), ratio %.1f, %.4f bits per texel\n",
                 static_cast<unsigned long long>(r.file_bytes), human_bytes(r.file_bytes).c_str(),
                 human_bytes(r.raw_bytes).c_str(), ratio, r.bits_per_texel);
    if (r.texels_that_matter)
        std::fprintf(
            to, "  mask   %.2f %% of the texels are not masked; PSNR and error refer to them\n",
            100.0 * static_cast<double>(*r.texels_that_matter) /
                static_cast<double>(texel_count(desc.size)));
    const std::string psnr = r.psnr >= 999 ? "lossless" : format_number(r.psnr, 2) + " dB";
    std::fprintf(to, "  PSNR   %s%s, largest error %.0f\n", psnr.c_str(),
                 traits_of(desc.type).is_float && r.psnr < 999 ? " (over 16-bit codes)" : "",
                 r.max_error);
    std::fprintf(to, "  time   %.2f s, %.1f MB/s, %u pass%s\n", r.seconds, speed, r.passes,
                 r.passes == 1 ? "" : "es");
    if (r.kept_tiles)
        std::fprintf(to, "  kept   %llu tiles of the reused file\n",
                     static_cast<unsigned long long>(*r.kept_tiles));
    for (const CodedLevel& level : r.coarse_levels)
        std::fprintf(to, "  level  %s in %llu bytes (%.2f %%), steps x%u\n",
                     to_string(level.size).c_str(), static_cast<unsigned long long>(level.bytes),
                     100.0 * static_cast<double>(level.bytes) / static_cast<double>(r.file_bytes),
                     1u << level.step_shift);
    if (!r.note.empty())
        std::fprintf(to, "  note   %s\n", r.note.c_str());
    if (r.looks_transposed)
        std::fprintf(
            to,
            "  note   objects move along v from one s to the next, and along u from one t to the "
            "next:\n         rows and columns of cameras seem to be swapped; in the right order "
            "the file is\n         far smaller (--order columns)\n");
}

Json report_json(const std::string& path, const TextureDesc& desc, const EncodeOptions& options,
                 const EncodeReport& r) {
    const bool lossless = r.psnr >= 999;
    Json json = {{"output", path},
                 {"size", to_string(desc.size)},
                 {"type", name_of(desc.type)},
                 {"channels", desc.channels},
                 {"rate", {{"kind", name_of(options.rate.kind)}, {"value", options.rate.value}}},
                 {"effort", options.effort},
                 {"bytes", r.file_bytes},
                 {"raw_bytes", r.raw_bytes},
                 {"bits_per_texel", r.bits_per_texel},
                 {"psnr", lossless ? Json(nullptr) : Json(r.psnr)}, // JSON has no infinity
                 {"lossless", lossless},
                 {"max_error", r.max_error},
                 {"seconds", r.seconds},
                 {"passes", r.passes},
                 {"target_met", r.target_met},
                 {"note", r.note},
                 {"looks_transposed", r.looks_transposed},
                 {"nan_count", r.nan_count},
                 {"infinity_count", r.infinity_count},
                 {"levels", Json::array()}};
    if (r.texels_that_matter)
        json["texels_that_matter"] = *r.texels_that_matter;
    if (r.kept_tiles) {
        json.erase("rate"); // that of the reused file applies
        json["kept_tiles"] = *r.kept_tiles;
    }
    for (const CodedLevel& level : r.coarse_levels)
        json["levels"].push_back({{"size", to_string(level.size)},
                                  {"bytes", level.bytes},
                                  {"step_shift", level.step_shift}});
    return json;
}

} // namespace tessera
