#include "codec/coarse_levels.h"

#include "codec/copy_box.h"
#include "codec/decoded_pass.h"
#include "codec/level_texels.h"
#include "codec/parallel.h"
#include "format/sample_code.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace tessera {
namespace {

// Shares of the payloads that the levels may take, finest first.
constexpr double level_share[] = {0.02, 0.003};
// By how much a whole level may miss what its sample promised.
constexpr double share_tolerance = 1.15;
constexpr unsigned largest_lod_step = 3;         // beyond the level before
constexpr unsigned largest_lod_sum = 4;          // more joins too much of anything
constexpr unsigned largest_shift = 8;            // 2^8 times the step is a blur
constexpr std::size_t trial_tiles = 6;           // of a candidate
constexpr std::size_t trial_interpolations = 96; // tiles of the texture, of a candidate
constexpr double index_bytes = 2;                // of a tile, about

// Everything that coding tiles of one level needs; refers to itself and stays where it is.
struct LevelCoder {
    LevelCoder(const EncodePlan& whole, const DecodedPass& texture, const LevelEntry& level)
        : source(texture, level), plan{source,
                                       whole.options,
                                       TileGrid(level.size, whole.options.tile_extent),
                                       whole.colour,
                                       whole.effort,
                                       nullptr} {
        plan.colour.desc.size = level.size;
        plan.colour.corrections = false; // nobody asked for exact means
    }
    LevelCoder(const LevelCoder&) = delete;
    LevelCoder& operator=(const LevelCoder&) = delete;

    LevelSource source;
    EncodePlan plan;
};

// How a level of some lods and step would do.
struct Candidate {
    LevelEntry entry;
    double error = std::numeric_limits<double>::infinity(); // mean squared, of codes
};

// Squared error and samples of the means of one coarse tile, interpolated over some of the tiles that
// it stands for.
struct Interpolation {
    double squared_error = 0, samples = 0;
};

Status interpolate_some(const DecodedPass& texture, const LevelEntry& entry, const Box4& box,
                        std::span<const std::byte> means, std::size_t count, Interpolation& sum) {
    const LevelEntry full{texture.grid().size(), 0, 0, 0};
    const TextureDesc& desc = texture.desc();
    const Box4 covered = covered_by(box, entry, full);
    // The tile alone, as if it were a level: what lies beyond its edge is not at hand.
    LevelEntry alone_full, alone = entry;
    alone_full.size = covered.extent();
    alone.size = box.extent();
    const std::vector<std::uint64_t> tiles = texture.grid().tiles_touched(covered);
    count = std::min(count, tiles.size());
    std::vector<std::byte> texels, part_texels, support_texels, interpolated;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t tile = tiles[golden_pick(i, tiles.size())];
        const Box4 tile_box = texture.grid().box(tile), part = intersect(tile_box, covered);
        TESSERA_TRY(texture.tile(tile, texels));
        part_texels.resize(static_cast<std::size_t>(desc.box_bytes(part)));
        copy_box(part, tile_box, texels, part, part_texels, desc.texel_bytes());
        Box4 inside;
        for (std::size_t axis = 0; axis < 4; ++axis) {
            inside.begin[axis] = part.begin[axis] - covered.begin[axis];
            inside.end[axis] = part.end[axis] - covered.begin[axis];
        }
        const Box4 support = support_of(inside, alone_full, alone);
        support_texels.resize(static_cast<std::size_t>(desc.box_bytes(support)));
        copy_box(support, Box4::whole(alone.size), means, support, support_texels,
                 desc.texel_bytes());
        interpolated.resize(part_texels.size());
        interpolate_level(support_texels, support, inside, alone_full, alone, desc, interpolated);
        CodedTile error;
        measure_error(part_texels, interpolated, desc.type, error);
        sum.squared_error += static_cast<double>(error.squared_error);
        sum.samples += static_cast<double>(part.texels() * desc.channels);
    }
    return {};
}

class LevelChooser {
public:
    LevelChooser(const EncodePlan& plan, const PassResult& pass)
        : plan_(plan), pass_(pass), texture_(plan, pass) {}

    // The level after `finer` that does best within `bytes`, coded; nothing where none does.
    Result<std::optional<CoarseLevel>> next(const LevelEntry& finer, double bytes) {
        std::vector<Candidate> candidates = candidates_after(finer);
        for (Candidate& candidate : candidates)
            TESSERA_TRY(try_out(candidate, bytes));
        const auto best = std::min_element(
            candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.error < b.error; });
        if (best == candidates.end() || !std::isfinite(best->error))
            return std::optional<CoarseLevel>();
        return code(best->entry, bytes);
    }

private:
    std::vector<Candidate> candidates_after(const LevelEntry& finer) const {
        std::vector<Candidate> candidates;
        const Extent4& size = plan_.grid.size();
        for (unsigned s = 0; s <= largest_lod_step; ++s)
            for (unsigned a = 0; a <= largest_lod_step; ++a) {
                const unsigned spatial = finer.spatial_lod + s, angular = finer.angular_lod + a;
                const LevelEntry entry = coarse_level(size, spatial, angular, 0);
                // Joining axes of one texel more would change nothing.
                const bool joins_uv = s == 0 || size[axis_u] > 1u << (spatial - 1) ||
                                      size[axis_v] > 1u << (spatial - 1);
                const bool joins_st = a == 0 || size[axis_s] > 1u << (angular - 1) ||
                                      size[axis_t] > 1u << (angular - 1);
                if (s + a > 0 && s + a <= largest_lod_sum && joins_uv && joins_st)
                    candidates.push_back({entry});
            }
        return candidates;
    }

    // Finds the smallest step shift that fits and the error that remains.
    Status try_out(Candidate& candidate, double bytes) {
        LevelCoder level(plan_, texture_, candidate.entry);
        Sample sample;
        const std::uint64_t tiles = level.plan.grid.tiles();
        const std::size_t wanted = std::min<std::uint64_t>(tiles, trial_tiles);
        for (std::size_t i = 0; i < wanted; ++i)
            sample.tiles.push_back(wanted == tiles ? i : golden_pick(i, tiles));
        sample.texels.resize(wanted);
        std::vector<Interpolation> ideal(wanted);
        std::vector<int> workers(thread_count(plan_.options.threads));
        TESSERA_TRY(parallel_for(
            workers, wanted,
            [&](int, std::size_t i) -> Status {
                const Box4 box = level.plan.grid.box(sample.tiles[i]);
                sample.texels[i].resize(
                    static_cast<std::size_t>(level.plan.colour.desc.box_bytes(box)));
                TESSERA_TRY(level.source.read(box, sample.texels[i]));
                return interpolate_some(texture_, candidate.entry, box, sample.texels[i],
                                        trial_interpolations / wanted + 1, ideal[i]);
            },
            [](std::size_t) {}));
        Interpolation sum;
        double sample_texels = 0;
        for (std::size_t i = 0; i < wanted; ++i) {
            sum.squared_error += ideal[i].squared_error;
            sum.samples += ideal[i].samples;
            sample_texels += static_cast<double>(level.plan.grid.box(sample.tiles[i]).texels());
        }
        const double samples = sample_texels * level.plan.colour.desc.channels;
        const double share = sample_texels / static_cast<double>(texel_count(candidate.entry.size));
        for (unsigned shift = 0; shift <= largest_shift; ++shift) {
            const Result<CodingParameters> parameters = with_coarser_steps(pass_.parameters, shift);
            if (!parameters)
                return {}; // the steps are as coarse as they can be
            const Result<PassResult> coded = run_pass(level.plan, *parameters, sample);
            TESSERA_TRY(coded.status());
            if (static_cast<double>(coded->payload_bytes()) / share +
                    index_bytes * static_cast<double>(tiles) >
                bytes)
                continue;
            candidate.entry.step_shift = static_cast<std::uint8_t>(shift);
            candidate.error =
                sum.squared_error / sum.samples + coded->totals.squared_error / samples;
            return {};
        }
        return {};
    }

    Result<std::optional<CoarseLevel>> code(LevelEntry entry, double bytes) {
        for (;; ++entry.step_shift) {
            const Result<CodingParameters> parameters =
                with_coarser_steps(pass_.parameters, entry.step_shift);
            if (!parameters || entry.step_shift > largest_shift)
                return std::optional<CoarseLevel>();
            LevelCoder level(plan_, texture_, entry);
            Result<PassResult> coded = run_pass(level.plan, *parameters, 0, "coarse levels");
            TESSERA_TRY(coded.status());
            CoarseLevel result{entry, std::move(coded->tiles), std::move(coded->payloads)};
            if (static_cast<double>(result.payload_bytes()) +
                    index_bytes * static_cast<double>(result.tiles.size()) <=
                bytes * share_tolerance)
                return std::optional(std::move(result));
        }
    }

    const EncodePlan& plan_;
    const PassResult& pass_;
    const DecodedPass texture_;
};

} // namespace

std::uint64_t CoarseLevel::payload_bytes() const {
    std::uint64_t bytes = 0;
    for (const CodedTile& tile : tiles)
        bytes += tile.payload_bytes;
    return bytes;
}

Result<std::vector<CoarseLevel>> make_coarse_levels(const EncodePlan& plan,
                                                    const PassResult& pass) {
    LevelChooser chooser(plan, pass);
    std::vector<CoarseLevel> levels;
    LevelEntry finer{plan.grid.size(), 0, 0, 0};
    for (const double share : level_share) {
        auto level = chooser.next(finer, share * static_cast<double>(pass.payload_bytes()));
        TESSERA_TRY(level.status());
        if (!*level)
            continue;
        finer = (*level)->entry;
        levels.push_back(std::move(**level));
    }
    return levels;
}

} // namespace tessera
