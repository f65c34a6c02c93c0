#include "codec/pass/encode_pass.h"

#include "codec/pass/levels_sum.h"
#include "codec/pass/tile_reuse.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/search_kernels/search_kernels.h"
#include "codec/texels/texel_mask.h"
#include "format/work.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace tessera {
namespace {

// Everything one thread needs to encode tiles and to see what they decode to.
struct Worker {
    TileEncoder encoder;
    std::optional<TileEncoder> careful; // of tiles that were edited in part
    TileDecoder decoder;
    TileLevels levels;
    CorrectionMap corrections;
    TileTexels tile;   // that is encoded, unless it is a sample's
    TileTexels target; // of a tile with texels that do not matter: they are as decoded
    std::vector<std::byte> decoded, payload;
    Statistics statistics;
};

// Coding state of a pass and its workers.
struct Crew {
    Crew(const EncodePlan& encode_plan, const CodingParameters& parameters, bool sample)
        : plan(encode_plan), of_sample(sample), counts(sample || encode_plan.effort.recode),
          coding(parameters, plan.colour.desc.type, plan.colour.desc.channels),
          costs(coding.tables), careful(settings_of_edited_tiles(plan.effort)) {
        for (unsigned i = 0; i < thread_count(plan.options.threads); ++i)
            workers.push_back({TileEncoder(coding, costs, plan.colour, plan.effort),
                               std::nullopt,
                               TileDecoder(coding, plan.colour),
                               {},
                               {},
                               {},
                               {},
                               {},
                               {},
                               {}});
    }
    // Leaves the tile's payload in worker.payload.
    // `filter`: what a filter would have to mend there; wanted only of passes without one.
    Status encode(Worker& worker, TileEncoder& encoder, const Box4& box, const TileTexels& source,
                  CodedTile& tile, FilterStatistics* filter = nullptr) const;
    // The same once worker.levels are chosen.
    Status code(Worker& worker, TileEncoder& encoder, const Box4& box, const TileTexels& source,
                CodedTile& tile, FilterStatistics* filter = nullptr) const;
    // The same of worker.tile, with the payload that a reused file has for it where that still holds.
    Status encode_or_keep(Worker& worker, std::uint64_t number, const Box4& box,
                          CodedTile& tile) const;

    const EncodePlan& plan;
    const bool of_sample;
    const bool verifies = !plan.effort.recode; // recoding has its own check
    const bool counts;                         // symbols, for tables
    const TileCoding coding;
    const BitCosts costs;
    const EffortSettings careful;
    std::vector<Worker> workers;
};

// Squared and largest error of bytes.
void measure_bytes(std::span<const std::byte> a, std::span<const std::byte> b, CodedTile& tile) {
    const ByteErrors errors =
        search_kernels().compare_bytes(reinterpret_cast<const unsigned char*>(a.data()),
                                       reinterpret_cast<const unsigned char*>(b.data()), a.size());
    tile.squared_error = errors.squared;
    tile.max_error = errors.largest;
}

// What the decoded tile is measured against: any value is right for texels that do not matter.
std::span<const std::byte> target_of(Worker& worker, const TileTexels& source,
                                     std::size_t texel_bytes) {
    if (source.matters.empty())
        return source.texels;
    worker.target = source;
    worker.target.replace_free(texel_bytes, worker.decoded);
    return worker.target.texels;
}

Status Crew::encode(Worker& worker, TileEncoder& encoder, const Box4& box, const TileTexels& source,
                    CodedTile& tile, FilterStatistics* filter) const {
    encoder.encode(source, tile_shape(box), worker.levels);
    return code(worker, encoder, box, source, tile, filter);
}

Status Crew::code(Worker& worker, TileEncoder& encoder, const Box4& box, const TileTexels& source,
                  CodedTile& tile, FilterStatistics* filter) const {
    const BlockShape shape = tile_shape(box);
    worker.decoded.resize(source.texels.size());
    worker.corrections.clear();
    if (filter != nullptr || !encoder.take_decoded(worker.decoded))
        worker.decoder.render(worker.levels, worker.corrections, worker.decoded);
    if (filter != nullptr)
        *filter = filter_statistics(encoder.source(), worker.decoder.planes(), coding);
    const TextureDesc& desc = plan.colour.desc;
    const std::span<const std::byte> texels = target_of(worker, source, desc.texel_bytes());
    const int error = coding.parameters.correction_error;
    if (plan.colour.corrections &&
        find_corrections(texels, worker.decoded, desc, error, worker.corrections)) {
        apply_corrections(worker.corrections, desc, error, worker.decoded);
    } else {
        worker.corrections.clear();
    }
    worker.payload.clear();
    encode_levels(worker.levels,
                  worker.corrections.empty()
                      ? std::vector<std::vector<std::byte>>{}
                      : encode_corrections(worker.corrections, shape, coding.planes, coding.tables),
                  coding, worker.payload);
    const bool is_stored = worker.payload.size() >= texels.size();
    if (is_stored) {
        copy_stored(texels, desc.type, worker.decoded);
        worker.payload = worker.decoded;
    }
    if (counts && (!is_stored || of_sample)) { // tables fitted to a sample may do better
        count_symbols(worker.levels, coding, worker.statistics);
        if (!worker.corrections.empty())
            count_corrections(worker.corrections, shape, coding.planes, worker.statistics);
    }
    measure_error(texels, worker.decoded, desc.type, tile);
    tile.levels_sum = sum_of(worker.levels, worker.corrections);
    tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
    if (is_stored || !verifies || !plan.options.verify)
        return {};
    // These bytes go to the file as they are: they must hold the levels that were measured.
    TESSERA_TRY(worker.decoder.parse(worker.payload, shape));
    return worker.decoder.levels() == worker.levels &&
                   worker.decoder.corrections() == worker.corrections
               ? Status()
               : about_texels(plan, {ErrorCode::runtime,
                                     "self-check failed: the tile of the texels " + to_string(box) +
                                         " does not decode to what was encoded"});
}

Status Crew::encode_or_keep(Worker& worker, std::uint64_t number, const Box4& box,
                            CodedTile& tile) const {
    if (plan.reused == nullptr)
        return encode(worker, worker.encoder, box, worker.tile, tile);
    const TextureDesc& desc = plan.colour.desc;
    TESSERA_TRY_ASSIGN(const bool is_usable, load_reusable_tile(plan, number, worker.payload));
    worker.decoded.resize(worker.tile.texels.size());
    TESSERA_TRY(worker.decoder.decode(worker.payload, tile_shape(box), worker.decoded)
                    .with_context(about_reused_tile(plan, number)));
    const std::span<const std::byte> texels = target_of(worker, worker.tile, desc.texel_bytes());
    measure_error(texels, worker.decoded, desc.type, tile);
    if (is_usable && tile.max_error == 0) {
        tile.levels_sum = 0; // which only recoding asks for, and such passes are not recoded
        tile.payload_bytes = static_cast<std::uint32_t>(worker.payload.size());
        return {};
    }
    if (!is_mostly_kept(texels, worker.decoded, desc.texel_bytes()))
        return encode(worker, worker.encoder, box, worker.tile, tile);
    if (!worker.careful)
        worker.careful.emplace(coding, costs, plan.colour, careful);
    return encode(worker, *worker.careful, box, worker.tile, tile);
}

PassResult finish(Crew& crew, unsigned number, std::vector<CodedTile> tiles,
                  std::shared_ptr<TileStore> payloads) {
    PassResult result{number,
                      crew.coding.parameters,
                      crew.coding.parameters,
                      std::move(tiles),
                      std::move(payloads),
                      {},
                      {}};
    PassTotals& totals = result.totals;
    for (const CodedTile& tile : result.tiles) {
        totals.squared_error += static_cast<double>(tile.squared_error);
        totals.max_error = std::max(totals.max_error, tile.max_error);
        totals.nan_count += tile.nan_count;
        totals.infinity_count += tile.infinity_count;
    }
    for (const Worker& worker : crew.workers)
        totals.statistics.add(worker.statistics);
    return result;
}

// Counts the symbols of the tiles that the journal holds. A tile's counts are many times larger than
// its payload and entropy decoding is quick, so they are not journaled but counted again, which
// also shows whether the payload can be decoded; if not, the tile is left to be encoded again.
Status count_journaled(Crew& crew, JournalTiles& journal) {
    const EncodePlan& plan = crew.plan;
    return parallel_for(
        crew.workers, plan.grid.tiles(),
        [&](Worker& worker, std::size_t tile) -> Status {
            if (!journal.has(tile))
                return {};
            TESSERA_TRY(check_cancelled(plan.options));
            TESSERA_TRY(journal.get(tile, worker.payload));
            const BlockShape shape = tile_shape(plan.grid.box(tile));
            if (!worker.decoder.parse(worker.payload, shape)) {
                journal.forget(tile);
                return {};
            }
            if (worker.decoder.is_stored())
                return {};
            count_symbols(worker.decoder.levels(), crew.coding, worker.statistics);
            if (!worker.decoder.corrections().empty())
                count_corrections(worker.decoder.corrections(), shape, crew.coding.planes,
                                  worker.statistics);
            return {};
        },
        [&](std::size_t i) {
            if (plan.options.progress)
                plan.options.progress("resume", static_cast<double>(i),
                                      static_cast<double>(plan.grid.tiles()));
        });
}

// Of texels that do not matter no sample is counted.
void make_free_finite(TileTexels& source, const TextureDesc& desc) {
    CodedTile ignored;
    for (std::size_t i = 0; i < source.matters.size(); ++i)
        if (source.is_free(i))
            make_finite(
                std::span(source.texels).subspan(i * desc.texel_bytes(), desc.texel_bytes()),
                desc.type, ignored);
}

// Whether the half at `at` is a NaN or infinite.
bool is_not_finite(const std::byte* at) {
    return (std::to_integer<unsigned>(at[1]) & 0x7C) == 0x7C;
}

// "texel u 3, v 0, s 1, t 2, channel 0 is NaN" of the first in the order of the box; "" without one.
std::string first_not_finite(std::span<const std::byte> texels, const Box4& box,
                             const TextureDesc& desc, const AlignedViews& views) {
    if (desc.type == SampleType::unorm8)
        return "";
    for (std::size_t i = 0; i + 1 < texels.size(); i += 2) {
        if (!is_not_finite(&texels[i]))
            continue;
        const Extent4 extent = box.extent();
        std::size_t left = i / 2 / desc.channels;
        Extent4 at{};
        for (const Axis axis : {axis_s, axis_t, axis_u, axis_v}) {
            at[axis] = box.begin[axis] + static_cast<std::uint32_t>(left % extent[axis]);
            left /= extent[axis];
        }
        at[axis_u] -= views.shift_u(at[axis_s]);
        at[axis_v] -= views.shift_v(at[axis_t]);
        const bool nan =
            (std::to_integer<unsigned>(texels[i + 1]) & 0x03) != 0 || texels[i] != std::byte{0};
        return "texel u " + std::to_string(at[axis_u]) + ", v " + std::to_string(at[axis_v]) +
               ", s " + std::to_string(at[axis_s]) + ", t " + std::to_string(at[axis_t]) +
               ", channel " + std::to_string(i / 2 % desc.channels) +
               (nan ? " is NaN" : " is infinite");
    }
    return "";
}

// Those that do not matter are finite.
Status read_texels(TexelSource& from, TexelSource* mask, const Box4& box, TileTexels& source) {
    source.texels.resize(from.desc().box_bytes(box));
    TESSERA_TRY(from.read(box, source.texels));
    TESSERA_TRY(read_mask(mask, box, source.matters));
    make_free_finite(source, from.desc());
    return {};
}

Status read_tile(const EncodePlan& plan, const Box4& box, TileTexels& source, CodedTile& tile) {
    TESSERA_TRY(check_cancelled(plan.options));
    const TextureDesc& desc = plan.colour.desc;
    TESSERA_TRY(read_texels(plan.source, plan.mask, box, source));
    const std::string first =
        plan.options.strict ? first_not_finite(source.texels, box, desc, plan.views) : "";
    make_finite(source.texels, desc.type, tile);
    if (!first.empty())
        return about_texels(plan, {ErrorCode::invalid_file,
                                   first + "; the texels " + to_string(box) + " hold " +
                                       std::to_string(tile.nan_count) + " NaN and " +
                                       std::to_string(tile.infinity_count) +
                                       " infinite samples (without --strict they are replaced)"});
    return {};
}

} // namespace

void make_finite(std::span<std::byte> texels, SampleType type, CodedTile& counts) {
    if (type == SampleType::unorm8)
        return;
    for (std::size_t i = 0; i + 1 < texels.size(); i += 2) {
        const unsigned high = std::to_integer<unsigned>(texels[i + 1]);
        if (!is_not_finite(&texels[i]))
            continue;
        const bool infinite = (high & 0x03) == 0 && texels[i] == std::byte{0};
        ++(infinite ? counts.infinity_count : counts.nan_count);
        texels[i] = static_cast<std::byte>(infinite ? 0xFF : 0);
        texels[i + 1] = static_cast<std::byte>(infinite ? (high & 0x80) | 0x7B : 0);
    }
}

void measure_error(std::span<const std::byte> a, std::span<const std::byte> b, SampleType type,
                   CodedTile& tile) {
    const std::size_t bytes = sample_bytes(type);
    const auto code = [&](std::span<const std::byte> texels, std::size_t i) {
        return sample_code(load_sample(texels.data() + i, type), type);
    };
    tile.squared_error = 0;
    tile.max_error = 0;
    if (type == SampleType::unorm8)
        return measure_bytes(a, b, tile);
    for (std::size_t i = 0; i < a.size(); i += bytes) {
        const auto error = static_cast<std::uint32_t>(std::abs(code(a, i) - code(b, i)));
        tile.squared_error += std::uint64_t{error} * error;
        tile.max_error = std::max(tile.max_error, error);
    }
}

double PassResult::psnr(const TextureDesc& desc, std::uint64_t texels) const {
    if (totals.squared_error == 0)
        return 999;
    const double peak = desc.type == SampleType::unorm8 ? 255.0 : 31743.0;
    const double samples = static_cast<double>(texels) * desc.channels;
    return 10.0 * std::log10(peak * peak * samples / totals.squared_error);
}

std::uint64_t PassResult::payload_bytes() const {
    std::uint64_t bytes = 0;
    for (const CodedTile& tile : tiles)
        bytes += tile.payload_bytes;
    return bytes;
}

double lagrangian_cost(const EncodePlan& plan, const CodingParameters& parameters,
                       const CodedTile& tile) {
    // Steps are such that an error of one in any plane of YCoCg counts three times over RGB.
    const double samples = plan.colour.transform == ColourTransform::ycocg_r ? 3 : 1;
    const double step = parameters.step[0].value();
    return static_cast<double>(tile.squared_error) / (samples * step * step) +
           8.0 * static_cast<double>(plan.effort.quantizer.lambda) * tile.payload_bytes;
}

double lagrangian_cost(const EncodePlan& plan, const PassResult& pass) {
    double cost = 0;
    for (const CodedTile& tile : pass.tiles)
        cost += lagrangian_cost(plan, pass.walked, tile);
    return cost;
}

Result<std::vector<Slab>> slabs_of(const EncodePlan& plan) {
    const TextureDesc& desc = plan.colour.desc;
    auto slabs = make_slabs(plan.grid, Box4::whole(desc.size), plan.source.locality(),
                            {plan.options.slab_bytes / desc.texel_bytes(), true});
    return slabs.ok() ? std::move(slabs) : about_texels(plan, slabs.status());
}

namespace {

// The tiles that a sample holds, ascending. They must not depend on how slabs are cut.
Result<std::vector<std::uint64_t>> choose_sample(const EncodePlan& plan, std::uint64_t wanted) {
    // Sources that are walked in slabs give the tiles of the middle one.
    TESSERA_TRY_ASSIGN(const auto uncut, make_slabs(plan.grid, Box4::whole(plan.grid.size()),
                                                    plan.source.locality()));
    const bool anywhere = plan.source.locality() == Locality::any;
    const Slab& middle = uncut[uncut.size() / 2];
    const std::uint64_t available = anywhere ? plan.grid.tiles() : middle.tiles.size();
    wanted = std::min(available, wanted);
    std::vector<std::uint64_t> tiles;
    for (std::uint64_t i = 0; i < wanted; ++i) {
        const std::uint64_t pick = golden_pick(i, available);
        tiles.push_back(anywhere ? pick : middle.tiles[pick]);
    }
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    return tiles;
}

// Tiles of the same places one after the other: their texels lie side by side in files.
void sort_by_places(const EncodePlan& plan, std::vector<std::uint64_t>& tiles) {
    const auto places = [&plan](std::uint64_t tile) {
        const Extent4 c = plan.grid.coordinates(tile);
        return std::pair(c[axis_v], c[axis_u]);
    };
    std::ranges::stable_sort(tiles, {}, places);
}

// Levels without those of blocks that are not a base picture's.
TileLevels tree_of(const TileLevels& levels, std::size_t planes) {
    TileLevels tree = levels;
    const std::size_t kept = levels.base_blocks * planes;
    if (kept < levels.planes.size())
        tree.nonzeros.resize(levels.planes[kept].first);
    tree.planes.resize(kept);
    tree.nonzeros.shrink_to_fit();
    return tree;
}

// Calls work(worker, i) -> Status for every tile of a sample.
template <class Work> Status for_each_tile(Crew& crew, const Sample& sample, const Work& work) {
    return parallel_for(
        crew.workers, sample.boxes.size(),
        [&](Worker& worker, std::size_t i) -> Status {
            TESSERA_TRY(check_cancelled(crew.plan.options));
            return work(worker, i);
        },
        [](std::size_t) {});
}

// What the levels count that choose(worker, i) leaves in worker.levels, of every tile of a sample.
template <class Choose>
Result<Statistics> count_all(Crew& crew, const Sample& sample, const Choose& choose) {
    TESSERA_TRY(for_each_tile(crew, sample, [&](Worker& worker, std::size_t i) -> Status {
        choose(worker, i);
        count_symbols(worker.levels, crew.coding, worker.statistics);
        return {};
    }));
    Statistics all;
    for (const Worker& worker : crew.workers)
        all.add(worker.statistics);
    return all;
}

} // namespace

Result<TileTexels> read_finite(TexelSource& source, TexelSource* mask, const Box4& box) {
    TileTexels tile;
    TESSERA_TRY(read_texels(source, mask, box, tile));
    CodedTile ignored;
    make_finite(tile.texels, source.desc().type, ignored);
    return tile;
}

std::uint64_t Sample::texel_count() const {
    return std::accumulate(boxes.begin(), boxes.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Box4& box) { return sum + box.texels(); });
}

std::uint64_t Sample::texels_that_matter() const {
    return std::accumulate(
        tiles.begin(), tiles.end(), texel_count(),
        [](std::uint64_t left, const TileTexels& tile) { return left - free_count(tile.matters); });
}

Result<Sample> read_sample(const EncodePlan& plan) {
    constexpr std::uint64_t large_tile = 131072; // texels; two are as much as four usual ones
    const std::uint64_t share = plan.effort.quick && plan.effort.recode ? 16 : 8;
    const std::uint64_t fewest = texel_count(plan.grid.tile_extent()) > large_tile ? 2 : 4;
    return read_sample(plan, std::clamp<std::uint64_t>(plan.grid.tiles() / share, fewest, 128));
}

Result<Sample> read_sample(const EncodePlan& plan, std::uint64_t wanted) {
    TESSERA_TRY_ASSIGN(const std::vector<std::uint64_t> numbers, choose_sample(plan, wanted));
    TESSERA_TRY_ASSIGN(const auto slabs, slabs_of(plan));
    Sample sample;
    for (const std::uint64_t number : numbers)
        sample.boxes.push_back(plan.grid.box(number));
    sample.tiles.resize(numbers.size());
    std::vector<int> workers(thread_count(plan.options.threads));
    for (const Slab& slab : slabs) {
        std::vector<std::size_t> inside; // of `numbers`
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (std::binary_search(slab.tiles.begin(), slab.tiles.end(), numbers[i]))
                inside.push_back(i);
        if (inside.empty())
            continue;
        TESSERA_TRY(plan.source.begin_slab(slab.box));
        TESSERA_TRY(parallel_for(
            workers, inside.size(),
            [&](int, std::size_t i) {
                CodedTile ignored;
                return read_tile(plan, sample.boxes[inside[i]], sample.tiles[inside[i]], ignored);
            },
            [&](std::size_t i) {
                if (plan.options.progress)
                    plan.options.progress("sample", static_cast<double>(i),
                                          static_cast<double>(inside.size()));
            }));
    }
    return sample;
}

Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            unsigned number, const char* stage) {
    Crew crew(plan, parameters, false);
    std::vector<CodedTile> tiles(plan.grid.tiles());
    std::shared_ptr<TileStore> payloads;
    const JournalTiles* journaled = nullptr;
    if (plan.journal != nullptr) {
        TESSERA_TRY_ASSIGN(auto opened, plan.journal->pass(number, parameters, tiles));
        TESSERA_TRY(count_journaled(crew, *opened));
        journaled = opened.get();
        payloads = std::move(opened);
    } else if (plan.keeps_payloads) {
        payloads = std::make_shared<MemoryTileStore>(tiles.size());
    }
    TESSERA_TRY_ASSIGN(const auto slabs, slabs_of(plan));
    double done = 0;
    for (const Slab& slab : slabs) {
        std::vector<std::uint64_t> wanted = slab.tiles;
        if (journaled != nullptr)
            std::erase_if(wanted, [&](std::uint64_t tile) { return journaled->has(tile); });
        done += static_cast<double>(slab.tiles.size() - wanted.size());
        if (wanted.empty())
            continue;
        sort_by_places(plan, wanted);
        TESSERA_TRY(plan.source.begin_slab(slab.box));
        TESSERA_TRY(parallel_for(
            crew.workers, wanted.size(),
            [&](Worker& worker, std::size_t i) -> Status {
                CodedTile& tile = tiles[wanted[i]];
                tile = {}; // a journal may have filled it before it gave the tile up
                const Box4 box = plan.grid.box(wanted[i]);
                TESSERA_TRY(read_tile(plan, box, worker.tile, tile));
                TESSERA_TRY(crew.encode_or_keep(worker, wanted[i], box, tile));
                return payloads == nullptr ? Status()
                                           : payloads->put(wanted[i], tile, worker.payload);
            },
            [&](std::size_t i) {
                if (plan.options.progress)
                    plan.options.progress(stage, done + static_cast<double>(i),
                                          static_cast<double>(tiles.size()));
            }));
        done += static_cast<double>(wanted.size());
    }
    return finish(crew, number, std::move(tiles), std::move(payloads));
}

Result<PassResult> run_pass(const EncodePlan& plan, const CodingParameters& parameters,
                            const Sample& sample, FilterStatistics* filter) {
    Crew crew(plan, parameters, true);
    std::vector<CodedTile> tiles(sample.boxes.size());
    // Summed in the order of the tiles, whichever thread had which.
    std::vector<FilterStatistics> statistics(filter != nullptr ? tiles.size() : 0);
    std::vector<TileLevels> trees(tiles.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](Worker& worker, std::size_t i) -> Status {
        TESSERA_TRY(crew.encode(worker, worker.encoder, sample.boxes[i], sample.tiles[i], tiles[i],
                                filter != nullptr ? &statistics[i] : nullptr));
        trees[i] = tree_of(worker.levels, static_cast<std::size_t>(crew.coding.planes));
        return {};
    }));
    for (const FilterStatistics& one : statistics)
        filter->add(one);
    PassResult pass = finish(crew, 0, std::move(tiles), nullptr);
    pass.trees = std::move(trees);
    return pass;
}

Result<PassResult> run_pass_as(const EncodePlan& plan, const CodingParameters& parameters,
                               const Sample& sample, std::span<const TileLevels> trees) {
    Crew crew(plan, parameters, true);
    std::vector<CodedTile> tiles(sample.boxes.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](Worker& worker, std::size_t i) {
        worker.encoder.encode_as(sample.tiles[i], trees[i], worker.levels);
        return crew.code(worker, worker.encoder, sample.boxes[i], sample.tiles[i], tiles[i]);
    }));
    return finish(crew, 0, std::move(tiles), nullptr);
}

Result<Statistics> count_symbols(const EncodePlan& plan, const CodingParameters& parameters,
                                 const Sample& sample) {
    Crew crew(plan, parameters, true);
    return count_all(crew, sample, [&](Worker& worker, std::size_t i) {
        worker.encoder.encode(sample.tiles[i], tile_shape(sample.boxes[i]), worker.levels);
    });
}

Result<Statistics> count_symbols_as(const EncodePlan& plan, const CodingParameters& parameters,
                                    const Sample& sample, std::span<const TileLevels> trees) {
    Crew crew(plan, parameters, true);
    return count_all(crew, sample, [&](Worker& worker, std::size_t i) {
        worker.encoder.encode_as(sample.tiles[i], trees[i], worker.levels);
    });
}

Result<std::vector<float>>
estimated_costs(const EncodePlan& plan, const CodingParameters& parameters, const Sample& sample) {
    Crew crew(plan, parameters, true);
    std::vector<float> costs(sample.boxes.size());
    TESSERA_TRY(for_each_tile(crew, sample, [&](Worker& worker, std::size_t i) -> Status {
        costs[i] =
            worker.encoder.estimate(sample.tiles[i], tile_shape(sample.boxes[i]), worker.levels);
        return {};
    }));
    return costs;
}

} // namespace tessera
