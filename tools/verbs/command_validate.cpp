#include "codec/decoder.h"
#include "format/byte_source.h"
#include "format/work.h"
#include "tools/http/open_bytes.h"
#include "tools/support/fill_text.h"
#include "tools/support/interrupt.h"
#include "tools/support/json_text.h"
#include "tools/support/parse.h"
#include "tools/support/progress.h"
#include "tools/support/texture_arguments.h"
#include "tools/verbs/command.h"
#include "tools/view/layer_files.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace tessera {
namespace {

constexpr int rule_tile = 50; // a tile's bytes decode to texels
constexpr std::size_t max_listed = 1000;

struct ValidateCommand {
    std::string input;
    TextureArguments texture; // threads and quiet
    bool json = false;
};

constexpr std::size_t tiles_at_once = 1 << 14;

// The tiles in which findings already report errors.
class CondemnedTiles {
public:
    explicit CondemnedTiles(const std::vector<Finding>& findings) {
        for (const Finding& f : findings) {
            std::uint64_t& end = ends_[f.first_tile];
            end = std::max(end, f.first_tile + f.tile_count);
        }
        std::uint64_t end = 0;
        for (auto& [first, range_end] : ends_) // a later range must not end earlier
            end = range_end = std::max(end, range_end);
    }
    bool contains(std::uint64_t tile) const {
        const auto after = ends_.upper_bound(tile);
        return after != ends_.begin() && tile < std::prev(after)->second;
    }

private:
    std::map<std::uint64_t, std::uint64_t> ends_; // first tile of a range -> end of the range
};

// Collects tiles of `group` and the groups behind it, enough for a while. Empty tiles are skipped,
// because a small file may claim millions of them. A group with an invalid record is already among
// the findings.
Result<std::vector<std::uint64_t>>
next_tiles(const ContainerReader& file, const CondemnedTiles& condemned, std::uint32_t& group) {
    std::vector<std::uint64_t> tiles;
    for (; group < file.group_count() && tiles.size() < tiles_at_once; ++group) {
        TESSERA_TRY(check_interrupt());
        const auto stored = file.nonempty_tiles(group);
        if (stored.ok())
            std::ranges::copy_if(*stored, std::back_inserter(tiles),
                                 [&](std::uint64_t tile) { return !condemned.contains(tile); });
        else if (stored.status().code() != ErrorCode::invalid_file)
            return stored.status();
    }
    return tiles;
}

// Decodes every tile in which the findings of the container report no error.
Status check_tiles(ByteSource& bytes, const DecodeOptions& options, unsigned threads,
                   const ProgressFunction& progress, std::vector<Finding>& findings) {
    const auto decoder = Decoder::open(bytes, options);
    if (!decoder.ok()) {
        findings.push_back({rule_tile, true, decoder.status().message(), 0, 0});
        return {};
    }
    const ContainerReader& file = decoder->container();
    const CondemnedTiles condemned(findings);
    std::mutex mutex;
    for (std::uint32_t group = 0; group < file.group_count();) {
        const std::uint32_t first = group;
        TESSERA_TRY_ASSIGN(const auto tiles, next_tiles(file, condemned, group));
        const double share = static_cast<double>(group - first) / static_cast<double>(tiles.size());
        std::uint64_t done = 0;
        TESSERA_TRY(parallel_for(tiles.size(), threads, [&](std::uint64_t i) -> Status {
            TESSERA_TRY(check_interrupt());
            const auto received = file.is_received(tiles[i]);
            const Status status =
                received.ok() && *received ? decoder->check_tile(tiles[i]) : received.status();
            if (status.code() == ErrorCode::io || status.code() == ErrorCode::runtime)
                return status; // not an error of the file
            const std::lock_guard lock(mutex);
            if (progress)
                progress("decoding tiles", first + share * static_cast<double>(++done),
                         file.group_count());
            if (!status.ok() && findings.size() < max_listed)
                findings.push_back({rule_tile, true, status.message(), tiles[i], 1});
            return {};
        }));
    }
    return {};
}

// Checks the container and the tiles of a file of one texture.
Result<std::vector<Finding>> check_file(ByteSource& bytes, const ValidateCommand& a,
                                        const ProgressFunction& progress) {
    const OpenOptions open{a.texture.decode.allow_partial};
    std::vector<Finding> findings = validate_container(
        bytes,
        [&](double done, double total) {
            if (progress)
                progress("checking pages", done, total);
        },
        open);
    // If the file does not open, its finding says why, and there are no tiles to check.
    if (ContainerReader::open(bytes, open).ok())
        TESSERA_TRY(check_tiles(bytes, a.texture.decode, a.texture.threads, progress, findings));
    return findings;
}

// Checks the further layers of a file, if it has any.
Status check_layers(ByteSource& bytes, const ValidateCommand& a, const ProgressFunction& progress,
                    std::vector<Finding>& findings) {
    const auto first = ContainerReader::open(bytes, {a.texture.decode.allow_partial});
    if (!first.ok())
        return {}; // there is a finding already
    for (const LayerInfo& info : first->layers().further) {
        const auto layer = layer_bytes(bytes, info);
        TESSERA_TRY_ASSIGN(const std::vector<Finding> own, check_file(*layer, a, progress));
        // Its tiles have numbers of their own.
        for (Finding finding : own) {
            finding.first_tile = finding.tile_count = 0;
            findings.push_back(std::move(finding));
        }
    }
    const Status fits = open_layers(bytes, *first, a.texture.decode).status();
    if (fits.code() == ErrorCode::invalid_file &&
        std::ranges::none_of(findings, [](const Finding& f) { return f.fatal; }))
        findings.push_back({static_cast<int>(ContainerRule::layers), true, fits.message(), 0, 0});
    return {};
}

void print_findings(const ValidateCommand& a, const std::vector<Finding>& findings, bool valid) {
    if (a.json) {
        Json json = {{"file", a.input}, {"valid", valid}, {"findings", Json::array()}};
        for (const Finding& f : findings)
            json["findings"].push_back({{"number", f.number},
                                        {"fatal", f.fatal},
                                        {"text", f.text},
                                        {"first_tile", f.first_tile},
                                        {"tile_count", f.tile_count}});
        print_json(json);
        return;
    }
    if (a.texture.quiet)
        return;
    for (const Finding& f : findings)
        std::printf("%s %02d: %s\n", f.fatal ? "error" : "note", f.number,
                    printable(f.text).c_str());
    if (valid)
        std::printf("%s: valid\n", a.input.c_str());
}

Status run(const ValidateCommand& a) {
    TESSERA_TRY_ASSIGN(const auto opened, open_bytes(a.input));
    // All bytes are read twice.
    const std::unique_ptr<ByteSource> ahead =
        opened->wants_prefetch() ? read_ahead(*opened) : nullptr;
    ByteSource& bytes = ahead ? *ahead : *opened;
    std::vector<Finding> findings;
    {
        Progress progress("tessera validate", a.texture.quiet || a.json);
        TESSERA_TRY_ASSIGN(findings, check_file(bytes, a, progress.function()));
        TESSERA_TRY(check_layers(bytes, a, progress.function(), findings));
    }
    std::stable_sort(findings.begin(), findings.end(), [](const Finding& x, const Finding& y) {
        return std::pair(x.number, x.first_tile) < std::pair(y.number, y.first_tile);
    });
    const auto fatal =
        std::count_if(findings.begin(), findings.end(), [](const Finding& f) { return f.fatal; });
    print_findings(a, findings, fatal == 0);
    if (fatal == 0)
        return {};
    for (const Finding& f : findings)
        if (f.number == static_cast<int>(ContainerRule::readable))
            return {interrupted_by() != 0 ? ErrorCode::runtime : ErrorCode::io, f.text};
    const Status invalid(ErrorCode::invalid_file, a.input + ": not valid, " +
                                                      std::to_string(fatal) +
                                                      (fatal == 1 ? " error" : " errors"));
    return with_partial_hint(invalid, bytes, a.texture.decode);
}

} // namespace

void add_validate_command(CLI::App& app, Invocation& chosen) {
    const auto declare = [](CLI::App& c, ValidateCommand& a) {
        c.add_option("file", a.input, "A .tess, its URL (http, https), or - for standard input")
            ->required();
        c.add_flag("--allow-partial", a.texture.decode.allow_partial,
                   "Check the beginning of a .tess, such as a broken download");
        c.add_flag("--json", a.json, "Print JSON");
        add_threads_options(c, a.texture);
        add_network_options(c);
    };
    add_verb<ValidateCommand>(
        app, chosen, "validate", "Check everything in a .tess that a reader relies on",
        "Each finding has a number: 1, the bytes cannot be read; 2 to 17, the head of the file; 20"
        " and 21, its index; 22, its mesh; 30, a page; 40 to 43, remarks that are not errors; 50, "
        "a tile; 99, there are more findings. The exit code is 3 if one is an error, 2 if the "
        "bytes cannot be read.\n\n"
        "Examples:\n"
        "  tessera validate scene.tess\n"
        "  tessera validate scene.tess --json",
        declare, run);
}

} // namespace tessera
