#include "codec/encoder.h"

#include "codec/decoder.h"
#include "codec/encode/coarse_levels.h"
#include "codec/encode/rate_control.h"
#include "codec/pass/encode_facts.h"
#include "codec/pass/tile_reuse.h"
#include "codec/texels/aligned_texels.h"
#include "codec/texels/texel_mask.h"
#include "codec/tile_encoder/tool_switches.h"
#include "codec/trials/alignment_choice.h"
#include "codec/trials/background.h"
#include "codec/trials/tile_choice.h"
#include "format/container/container_writer.h"
#include "format/metadata.h"

#include <algorithm>
#include <chrono>
#include <memory>

namespace tessera {
namespace {

// What a pass makes a file of.
struct FileParts {
    const EncodePlan& plan;
    const PassResult& pass;
    std::vector<std::byte> coding; // section CODE
    std::vector<CoarseLevel> levels;

    // The level of a tile, and its number there.
    struct Place {
        const std::vector<CodedTile>& tiles;
        const TileStore& payloads;
        std::uint64_t number;
    };
    Place place_of(std::uint64_t tile) const {
        if (tile < pass.tiles.size())
            return {pass.tiles, *pass.payloads, tile};
        tile -= pass.tiles.size();
        std::size_t level = 0;
        for (; tile >= levels[level].tiles.size(); ++level)
            tile -= levels[level].tiles.size();
        return {levels[level].tiles, *levels[level].payloads, tile};
    }

    // Whether a tile is as long as its texels, which makes it a stored one.
    bool has_stored_tiles() const {
        const auto any = [this](const Extent4& size, const std::vector<CodedTile>& tiles) {
            const TileGrid grid(size, plan.grid.tile_extent());
            for (std::uint64_t i = 0; i < tiles.size(); ++i)
                if (tiles[i].payload_bytes == plan.colour.desc.box_bytes(grid.box(i)))
                    return true;
            return false;
        };
        return any(plan.grid.size(), pass.tiles) ||
               std::ranges::any_of(levels, [&any](const CoarseLevel& level) {
                   return any(level.entry.size, level.tiles);
               });
    }
};

// The coarse levels of the pass that was looked at last: rate control asks for the size of the file
// before it is written.
struct LatestLevels {
    unsigned pass = 0;
    std::vector<CoarseLevel> levels;
};

Result<FileParts> parts_of(const EncodePlan& plan, const PassResult& pass, LatestLevels& latest) {
    if (plan.options.layers && latest.pass != pass.number) {
        TESSERA_TRY_ASSIGN(std::vector<CoarseLevel> levels, make_coarse_levels(plan, pass));
        latest = {pass.number, std::move(levels)};
    }
    return FileParts{plan, pass, write_coding_parameters(pass.parameters), latest.levels};
}

// Assembles a file; refers to `parts`.
ContainerContents contents_of(const FileParts& parts) {
    const EncodePlan& plan = parts.plan;
    ContainerContents contents;
    contents.desc = plan.colour.desc;
    contents.desc.size = plan.views.texture_size();
    contents.alignment = plan.views.alignment();
    contents.tile_extent = plan.grid.tile_extent();
    contents.description = plan.options.description;
    contents.metadata = recorded_metadata(plan);
    contents.colour = plan.colour.transform;
    contents.background = plan.colour.background;
    contents.required_features = (plan.colour.corrections ? feature_corrections : 0) |
                                 (parts.pass.parameters.prediction ? feature_prediction : 0) |
                                 (parts.has_stored_tiles() ? feature_stored : 0);
    contents.codec_parameters = parts.coding;
    contents.proxy_mesh = plan.options.mesh;
    for (const CoarseLevel& level : parts.levels)
        contents.coarse_levels.push_back(level.entry);
    contents.tile_length = [&parts](std::uint64_t tile) -> std::uint64_t {
        const FileParts::Place place = parts.place_of(tile);
        return place.tiles[place.number].payload_bytes;
    };
    contents.tile = [&parts, payload = std::vector<std::byte>()](
                        std::uint64_t tile) mutable -> Result<std::span<const std::byte>> {
        TESSERA_TRY(check_cancelled(parts.plan.options));
        const FileParts::Place place = parts.place_of(tile);
        TESSERA_TRY(place.payloads.get(place.number, payload));
        return std::span<const std::byte>(payload);
    };
    return contents;
}

// An encode up to its file.
struct Attempt {
    // Of aligned views, nullptr of others: texels that had to be held, texels and mask in the grid.
    std::unique_ptr<TexelSource> held, texels, mask;
    EncodePlan plan;
    RateOutcome outcome;
    LatestLevels latest;
    bool looks_transposed = false;
};

EncodePlan plan_of(TexelSource& source, const EncodeOptions& options, const ToolSwitches& tools,
                   std::uint64_t texels_that_matter) {
    const TextureDesc desc = source.desc();
    const EffortSettings effort = EffortSettings::of(options.effort, tools);
    return {source,
            options,
            {},
            {desc,
             desc.channels >= 3 && effort.ycocg ? ColourTransform::ycocg_r : ColourTransform::none,
             {},
             options.rate.kind == RateTarget::Kind::max_error,
             true},
            effort,
            nullptr,
            options.mask,
            texels_that_matter,
            tools,
            true,
            nullptr,
            AlignedViews(desc.size, {})};
}

// An attempt of which only the plan is there, without its grid of tiles.
Result<std::unique_ptr<Attempt>> begin_attempt(TexelSource& source, const EncodeOptions& options,
                                               const ToolSwitches& tools) {
    const Extent4 size = source.desc().size;
    TESSERA_TRY_ASSIGN(const std::uint64_t matter,
                       count_texels_that_matter(options.mask, size, options.threads));
    const EncodePlan plain = plan_of(source, options, tools, matter);
    ViewMotion motion;
    if (options.reuse != nullptr) {
        motion.alignment = options.reuse->container().alignment();
    } else {
        TESSERA_TRY_ASSIGN(motion, motion_between_views(plain));
    }
    const auto attempt_by = [&motion](EncodePlan plan) {
        plan.parallax = motion.parallax;
        return std::unique_ptr<Attempt>(
            new Attempt{nullptr, nullptr, nullptr, plan, {}, {}, motion.looks_transposed});
    };
    const ViewAlignment& alignment = motion.alignment;
    if (!alignment.any())
        return attempt_by(plain);
    TESSERA_TRY_ASSIGN(auto held, hold_slabs(source, options.threads, options.slab_bytes));
    TexelSource& any_order = held ? *held : source;
    if (options.reuse == nullptr) {
        TESSERA_TRY_ASSIGN(const bool pays, alignment_pays(plain, any_order, alignment));
        if (!pays)
            return attempt_by(plain);
    }
    const AlignedViews views(size, alignment);
    auto texels = texels_in_grid(any_order, views), mask = mask_of_grid(options.mask, views);
    EncodePlan plan = plan_of(*texels, options, tools, matter);
    plan.mask = mask.get();
    plan.views = views;
    std::unique_ptr<Attempt> made = attempt_by(plan);
    made->held = std::move(held);
    made->texels = std::move(texels);
    made->mask = std::move(mask);
    return made;
}

// Finds the pass that meets the rate. `source` and `options` outlive what comes back; `journal` may be
// nullptr.
Result<std::unique_ptr<Attempt>> attempt(TexelSource& source, const EncodeOptions& options,
                                         Journal* journal) {
    TESSERA_TRY_ASSIGN(const ToolSwitches tools, parse_tool_switches(options.tools));
    TESSERA_TRY_ASSIGN(std::unique_ptr<Attempt> made, begin_attempt(source, options, tools));
    EncodePlan& plan = made->plan;
    const TextureDesc& desc = plan.colour.desc;
    const bool resume = options.journal == JournalUse::resume;
    if (journal != nullptr && resume)
        TESSERA_TRY(journal->may_resume(facts_of(plan)));
    CodingParameters reused;
    if (options.reuse != nullptr) {
        TESSERA_TRY_ASSIGN(reused, plan_reuse(*options.reuse, plan));
    } else {
        TESSERA_TRY_ASSIGN(const Extent4 tile_extent, choose_tile_extent(plan));
        plan.grid = TileGrid(desc.size, tile_extent);
    }
    if (plan.grid.tiles() > max_tiles)
        return Status(ErrorCode::unsupported, "more than 2^32 - 1 tiles");
    TESSERA_TRY_ASSIGN(const Sample sample, read_sample(plan));
    if (options.reuse == nullptr)
        plan.colour.background = find_background(sample, desc);
    if (journal != nullptr) {
        TESSERA_TRY(journal->begin(facts_of(plan, sample), resume));
        plan.journal = journal;
    }
    if (options.reuse != nullptr) { // which says at what rate, and under which tables
        TESSERA_TRY_ASSIGN(made->outcome.pass, run_pass(plan, reused, 1, "encode"));
        made->outcome.passes = 1;
        return made;
    }
    TESSERA_TRY_ASSIGN(
        made->outcome,
        control_rate(plan, sample, [&](const PassResult& pass) -> Result<std::uint64_t> {
            TESSERA_TRY_ASSIGN(const FileParts parts, parts_of(plan, pass, made->latest));
            return container_bytes(contents_of(parts));
        }));
    return made;
}

Result<std::uint64_t> file_bytes_of(Attempt& made) {
    TESSERA_TRY_ASSIGN(const FileParts parts, parts_of(made.plan, made.outcome.pass, made.latest));
    return container_bytes(contents_of(parts));
}

// No step reaches the PSNR that was asked for: a lossless file does, and takes its place where it is
// smaller or wanted. `lossless` outlives `made`. Its payloads stay in memory: a journal has one encode.
Status fall_back(TexelSource& source, const EncodeOptions& lossless,
                 std::unique_ptr<Attempt>& made) {
    if (!lossless.lossless_fallback && !source.cheap_to_reread())
        return {};
    TESSERA_TRY_ASSIGN(std::unique_ptr<Attempt> other, attempt(source, lossless, nullptr));
    TESSERA_TRY_ASSIGN(const std::uint64_t bytes, file_bytes_of(*other));
    TESSERA_TRY_ASSIGN(const std::uint64_t missed_by, file_bytes_of(*made));
    if (!lossless.lossless_fallback && bytes >= missed_by)
        return {};
    other->outcome.passes += made->outcome.passes;
    other->outcome.note =
        "no quantiser reaches the target: the file is lossless" +
        std::string(bytes < missed_by ? ", which is smaller than the finest quantiser's" : "");
    made = std::move(other);
    return {};
}

EncodeReport report_on(const Attempt& made, const FileParts& parts, std::uint64_t bytes) {
    const EncodePlan& plan = made.plan;
    const PassResult& pass = made.outcome.pass;
    const TextureDesc& desc = plan.colour.desc;
    const Extent4& size = plan.views.texture_size();
    EncodeReport report;
    report.file_bytes = bytes;
    report.raw_bytes = desc.box_bytes(Box4::whole(size));
    report.bits_per_texel =
        static_cast<double>(bytes) * 8.0 / static_cast<double>(texel_count(size));
    if (plan.options.mask != nullptr)
        report.texels_that_matter = plan.texels_that_matter;
    report.psnr = pass.psnr(desc, plan.texels_that_matter);
    report.max_error = pass.totals.max_error;
    report.nan_count = pass.totals.nan_count;
    report.infinity_count = pass.totals.infinity_count;
    report.passes = made.outcome.passes;
    report.target_met = !made.outcome.is_missed;
    report.note = made.outcome.note;
    report.looks_transposed = made.looks_transposed;
    for (const CoarseLevel& level : parts.levels)
        report.coarse_levels.push_back(
            {level.entry.size, level.entry.step_shift, level.payload_bytes()});
    return report;
}

// `journal` may be nullptr.
Result<EncodeReport> encode(TexelSource& source, const EncodeOptions& options, Journal* journal,
                            const std::function<Status(const ContainerContents&)>& write) {
    const auto start = std::chrono::steady_clock::now();
    TESSERA_TRY_ASSIGN(std::unique_ptr<Attempt> made, attempt(source, options, journal));
    EncodeOptions lossless = options;
    lossless.rate = {RateTarget::Kind::max_error, 0};
    if (texel_count(lossless.tile_extent) > max_corrected_texels)
        lossless.tile_extent = tile_by_trial;
    if (made->outcome.is_missed)
        TESSERA_TRY(fall_back(source, lossless, made));
    TESSERA_TRY_ASSIGN(const FileParts parts,
                       parts_of(made->plan, made->outcome.pass, made->latest));
    const ContainerContents contents = contents_of(parts);
    TESSERA_TRY_ASSIGN(const std::uint64_t bytes, container_bytes(contents));
    if (options.confirm)
        TESSERA_TRY(options.confirm());
    TESSERA_TRY(write(contents));
    EncodeReport report = report_on(*made, parts, bytes);
    if (options.reuse != nullptr) {
        TESSERA_TRY_ASSIGN(report.kept_tiles, count_kept_tiles(made->plan, made->outcome.pass));
    }
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

Result<EncodeReport> encode_in_memory(TexelSource& source, const std::string& path,
                                      const EncodeOptions& options) {
    // Created first: a folder that cannot be written to should cost no encoding.
    TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(path));
    return encode(source, options, nullptr, [&file](const ContainerContents& contents) -> Status {
        FileSink sink(file);
        TESSERA_TRY(write_container(contents, sink));
        return file.commit();
    });
}

Result<EncodeReport> encode_with_journal(TexelSource& source, const std::string& path,
                                         const EncodeOptions& options) {
    TESSERA_TRY_ASSIGN(std::unique_ptr<Journal> journal, Journal::open(path));
    Result<EncodeReport> report =
        encode(source, options, journal.get(), [&](const ContainerContents& contents) -> Status {
            // Inside the journal, so that a kill leaves nothing else.
            TESSERA_TRY_ASSIGN(OutputFile file, OutputFile::create(path, journal->output_path()));
            FileSink sink(file);
            TESSERA_TRY(write_container(contents, sink));
            return file.commit();
        });
    // Options that cannot be met cannot be met by going on either.
    const bool hopeless = !report.ok() && journal->begun() &&
                          (report.status().code() == ErrorCode::bad_argument ||
                           (options.confirm && !options.confirm().ok()));
    if (report || hopeless)
        journal->remove();
    else if (journal->can_resume())
        return Status(report.status().code(), report.status().message() +
                                                  "; finished tiles are kept in " +
                                                  journal->folder());
    return report;
}

} // namespace

Result<EncodeReport>
encode_stream(TexelSource& source,
              const std::function<Status(std::span<const std::byte> piece)>& write,
              const EncodeOptions& options) {
    class Stream : public ByteSink {
    public:
        explicit Stream(const std::function<Status(std::span<const std::byte>)>& to) : to_(to) {}
        Status append(std::span<const std::byte> bytes) override { return to_(bytes); }

    private:
        const std::function<Status(std::span<const std::byte>)>& to_;
    };
    try {
        TESSERA_TRY(check_options(source.desc(), options));
        return encode(source, options, nullptr, [&](const ContainerContents& contents) -> Status {
            Stream sink(write);
            TESSERA_TRY(write_container(contents, sink));
            return {};
        });
    } catch (const std::exception& e) {
        return Status(ErrorCode::runtime, e.what());
    }
}

Result<EncodeReport> encode_memory(TexelSource& source, std::vector<std::byte>& out,
                                   const EncodeOptions& options) {
    out.clear();
    return encode_stream(
        source,
        [&out](std::span<const std::byte> piece) -> Status {
            out.insert(out.end(), piece.begin(), piece.end());
            return {};
        },
        options);
}

Result<EncodeReport> encode_file(TexelSource& source, const std::string& path,
                                 const EncodeOptions& options) {
    try {
        TESSERA_TRY(check_options(source.desc(), options));
        return options.journal == JournalUse::none ? encode_in_memory(source, path, options)
                                                   : encode_with_journal(source, path, options);
    } catch (const std::exception& e) {
        return Status(ErrorCode::runtime, e.what());
    }
}

} // namespace tessera
