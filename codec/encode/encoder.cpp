#include "codec/encoder.h"

#include "codec/encode/encode_to_rate.h"
#include "codec/encode/encode_with_tools.h"
#include "codec/encode/file_contents.h"
#include "codec/pass/tile_reuse.h"
#include "format/output_file.h"
#include "format/tile/limits.h"

#include <chrono>
#include <memory>
#include <utility>

namespace tessera {
namespace {

// Writes a file.
using Write = std::function<Status(const ContainerContents&)>;
using WritePiece = std::function<Status(std::span<const std::byte>)>;

// No step reaches the target PSNR: replaces `encode` by a lossless one if that is smaller or the caller
// wants it. `lossless` outlives `encode`. The journal serves one encode, so the lossless one does
// without.
Status fall_back(TexelSource& source, const EncodeOptions& lossless, const ToolSwitches& tools,
                 std::unique_ptr<TextureEncode>& encode) {
    if (!lossless.lossless_fallback && !source.cheap_to_reread())
        return {};
    TESSERA_TRY_ASSIGN(auto other, encode_to_rate(source, lossless, tools, nullptr));
    TESSERA_TRY_ASSIGN(const std::uint64_t bytes, other->file_bytes(other->outcome.pass));
    TESSERA_TRY_ASSIGN(const std::uint64_t missed_by, encode->file_bytes(encode->outcome.pass));
    if (!lossless.lossless_fallback && bytes >= missed_by)
        return {};
    other->outcome.passes += encode->outcome.passes;
    other->outcome.note =
        "no quantiser reaches the target: the file is lossless" +
        std::string(bytes < missed_by ? ", which is smaller than the finest quantiser's" : "");
    encode = std::move(other);
    return {};
}

EncodeReport report_on(const TextureEncode& encode, std::uint64_t file_bytes) {
    const EncodePlan& plan = encode.plan;
    const PassTotals& totals = encode.outcome.pass.totals;
    const Extent4& size = plan.views.texture_size();
    EncodeReport report;
    report.file_bytes = file_bytes;
    report.raw_bytes = plan.colour.desc.box_bytes(Box4::whole(size));
    report.bits_per_texel =
        static_cast<double>(file_bytes) * 8.0 / static_cast<double>(texel_count(size));
    if (plan.options.mask != nullptr)
        report.texels_that_matter = plan.texels_that_matter;
    report.psnr = encode.outcome.pass.psnr(plan.colour.desc, plan.texels_that_matter);
    report.max_error = totals.max_error;
    report.nan_count = totals.nan_count;
    report.infinity_count = totals.infinity_count;
    report.passes = encode.outcome.passes;
    report.target_met = !encode.outcome.is_missed;
    report.note = encode.outcome.note;
    report.looks_transposed = encode.looks_transposed;
    for (const CoarseLevel& level : encode.levels)
        report.coarse_levels.push_back(
            {level.entry.size, level.entry.step_shift, level.payload_bytes()});
    return report;
}

// The stages of every encode. `journal` may be nullptr.
Result<EncodeReport> encode(TexelSource& source, const EncodeOptions& options,
                            const ToolSwitches& tools, Journal* journal, const Write& write) {
    const auto start = std::chrono::steady_clock::now();
    EncodeOptions lossless = options;
    lossless.rate = {RateTarget::Kind::max_error, 0};
    if (texel_count(lossless.tile_extent) > max_corrected_texels)
        lossless.tile_extent = tile_by_trial;
    TESSERA_TRY_ASSIGN(auto encode, encode_to_rate(source, options, tools, journal));
    if (encode->outcome.is_missed)
        TESSERA_TRY(fall_back(source, lossless, tools, encode));
    const PassResult& pass = encode->outcome.pass;
    TESSERA_TRY(encode->make_levels(pass));
    const FileContents file(encode->plan, pass, encode->levels);
    TESSERA_TRY_ASSIGN(const std::uint64_t bytes, file.bytes());
    if (options.confirm)
        TESSERA_TRY(options.confirm());
    TESSERA_TRY(write(file.contents()));
    EncodeReport report = report_on(*encode, bytes);
    if (options.reuse != nullptr) {
        TESSERA_TRY_ASSIGN(report.kept_tiles, count_kept_tiles(encode->plan, pass));
    }
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

Result<EncodeReport> encode_without_journal(TexelSource& source, const std::string& path,
                                            const EncodeOptions& options) {
    // Created first: if the folder cannot be written to, no time is spent on encoding.
    TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(path));
    return encode(source, options, {}, nullptr, [&file](const ContainerContents& contents) {
        FileSink sink(file);
        TESSERA_TRY(write_container(contents, sink));
        return file.commit();
    });
}

Result<EncodeReport> encode_with_journal(TexelSource& source, const std::string& path,
                                         const EncodeOptions& options) {
    TESSERA_TRY_ASSIGN(std::unique_ptr<Journal> journal, Journal::open(path));
    Result<EncodeReport> report = encode(
        source, options, {}, journal.get(), [&](const ContainerContents& contents) -> Status {
            // Inside the journal, so that a kill leaves nothing else.
            TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(path, journal->output_path()));
            FileSink sink(file);
            TESSERA_TRY(write_container(contents, sink));
            return file.commit();
        });
    // Neither bad options nor a changed source get better by a resume.
    const bool is_hopeless = !report.ok() && journal->begun() &&
                             (report.status().code() == ErrorCode::bad_argument ||
                              (options.confirm && !options.confirm().ok()));
    if (report || is_hopeless)
        journal->remove();
    else if (journal->can_resume())
        return Status(report.status().code(), report.status().message() +
                                                  "; finished tiles are kept in " +
                                                  journal->folder());
    return report;
}

// Calls run() if the options are valid. No exception leaves it.
template <class Run>
Result<EncodeReport> checked(TexelSource& source, const EncodeOptions& options, const Run& run) {
    try {
        TESSERA_TRY(check_options(source.desc(), options));
        return run();
    } catch (const std::exception& e) {
        return Status(ErrorCode::runtime, e.what());
    }
}

Result<EncodeReport> encode_pieces(TexelSource& source, const WritePiece& write,
                                   const EncodeOptions& options, const ToolSwitches& tools) {
    struct Stream : ByteSink {
        explicit Stream(const WritePiece& to) : write(to) {}
        Status append(std::span<const std::byte> bytes) override { return write(bytes); }
        const WritePiece& write;
    };
    return checked(source, options, [&] {
        return encode(source, options, tools, nullptr, [&](const ContainerContents& contents) {
            Stream sink(write);
            return write_container(contents, sink).status();
        });
    });
}

} // namespace

Result<EncodeReport>
encode_stream(TexelSource& source,
              const std::function<Status(std::span<const std::byte> piece)>& write,
              const EncodeOptions& options) {
    return encode_pieces(source, write, options, {});
}

Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options, const ToolSwitches& tools) {
    out.clear();
    return encode_pieces(
        source,
        [&out](std::span<const std::byte> piece) {
            out.insert(out.end(), piece.begin(), piece.end());
            return Status();
        },
        options, tools);
}

Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options) {
    return encode_memory(source, out, options, {});
}

Result<EncodeReport> encode_file(TexelSource& source, const std::string& path,
                                 const EncodeOptions& options) {
    return checked(source, options, [&] {
        return options.journal == JournalUse::none ? encode_without_journal(source, path, options)
                                                   : encode_with_journal(source, path, options);
    });
}

} // namespace tessera
