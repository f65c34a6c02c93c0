#include "codec/encode/coarse_levels.h"

#include "codec/pass/decoded_pass.h"
#include "codec/texels/level_texels.h"
#include "format/samples.h"
#include "format/texture.h"
#include "format/work.h"

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
constexpr unsigned largest_lod_step = 3; // beyond the level before
constexpr unsigned largest_lod_sum = 4;  // more joins too much of anything
constexpr unsigned largest_shift = 8;    // 2^8 times the step is a blur
constexpr std::size_t patches = 16;      // of the texture, in which candidates are compared
// (A patch of the candidate's own tiles took three times as long and was at the mercy of chance.)
// Tiles of a candidate that are coded, fewer where each stands for many tiles of the texture.
constexpr std::size_t trial_tiles = 6, fewest_trial_tiles = 2;
constexpr std::size_t trial_reads = 256; // tiles of the texture, about, of a candidate
constexpr double index_bytes = 2;        // of a tile, about

constexpr double unusable = std::numeric_limits<double>::infinity();

// Everything that coding tiles of one level needs; refers to itself and stays where it is.
struct LevelCoder {
    LevelCoder(const EncodePlan& whole, const DecodedPass& texture, const LevelEntry& level)
        : source(texture, level), plan{source, whole.options,
                                       TileGrid(level.size, whole.grid.tile_extent()), whole.colour,
                                       whole.effort} { // means of decoded texels all matter
        plan.colour.desc.size = level.size;
        plan.colour.corrections = false; // nobody asked for exact means
        plan.tools = whole.tools;
    }
    LevelCoder(const LevelCoder&) = delete;
    LevelCoder& operator=(const LevelCoder&) = delete;

    LevelSource source;
    EncodePlan plan;
};

// A level of some lods, and how it would do.
struct Candidate {
    LevelEntry entry;
    double ideal = 0;        // mean squared error, of codes, of the means themselves, interpolated
    double error = unusable; // the same, of the means as coded
};

// A part of the texture in which candidates are compared: of two tiles along every axis, as the middle
// of it is interpolated.
struct Patch {
    Extent4 size{};
    std::vector<std::byte> texels;
};

Status read_patch(const DecodedPass& texture, std::uint64_t tile, Patch& patch) {
    const TileGrid& grid = texture.grid();
    Box4 box = grid.box(tile);
    for (std::size_t axis = 0; axis < 4; ++axis) {
        const std::uint32_t two = 2 * grid.tile_extent()[axis];
        box.begin[axis] -= box.begin[axis] % two;
        box.end[axis] = std::min(box.begin[axis] + two, grid.size()[axis]);
    }
    patch.size = box.extent();
    patch.texels.resize(static_cast<std::size_t>(texture.desc().box_bytes(box)));
    std::vector<std::byte> texels;
    for (const std::uint64_t number : grid.tiles_touched(box)) {
        TESSERA_TRY(texture.tile(number, texels));
        const Box4 tile_box = grid.box(number), part = intersect(tile_box, box);
        copy_box(part, tile_box, texels, box, patch.texels, texture.desc().texel_bytes());
    }
    return {};
}

// Squared error, of codes, and its samples.
struct ErrorSum {
    double squared_error = 0, samples = 0;
};

// Adds what is lost in the middle of the patch when it is interpolated from means of 2^lods texels.
void add_error(const Patch& patch, const LevelEntry& lods, const TextureDesc& desc, ErrorSum& sum) {
    const LevelEntry full{patch.size, 0, 0, 0};
    const LevelEntry coarse = coarse_level(patch.size, lods.spatial_lod, lods.angular_lod, 0);
    Box4 middle;
    for (std::size_t axis = 0; axis < 4; ++axis) {
        middle.begin[axis] = patch.size[axis] / 4;
        middle.end[axis] = patch.size[axis] - middle.begin[axis];
    }
    const Box4 whole = Box4::whole(patch.size), support = support_of(middle, full, coarse);
    const auto bytes_of = [&desc](const Box4& box) {
        return static_cast<std::size_t>(desc.box_bytes(box));
    };
    LevelMeans sums(desc, full, coarse, support);
    sums.add(whole, patch.texels);
    std::vector<std::byte> means(bytes_of(support));
    sums.finish(means);
    std::vector<std::byte> original(bytes_of(middle)), interpolated(bytes_of(middle));
    interpolate_level(means, support, middle, full, coarse, desc, interpolated);
    copy_box(middle, whole, patch.texels, middle, original, desc.texel_bytes());
    CodedTile error;
    measure_error(original, interpolated, desc.type, error);
    sum.squared_error += static_cast<double>(error.squared_error);
    sum.samples += static_cast<double>(middle.texels() * desc.channels);
}

class LevelChooser {
public:
    LevelChooser(const EncodePlan& plan, const PassResult& pass)
        : plan_(plan), pass_(pass), texture_(plan, pass) {}

    // The level after `finer` that does best within `bytes`, coded; nothing where none does.
    Result<std::optional<CoarseLevel>> next(const LevelEntry& finer, double bytes) {
        std::vector<Candidate> candidates = candidates_after(finer);
        TESSERA_TRY(compare_means(candidates));
        std::ranges::sort(candidates, {}, &Candidate::ideal);
        const Candidate* best = nullptr;
        for (Candidate& candidate : candidates) {
            const double least = best != nullptr ? best->error : unusable;
            if (candidate.ideal >= least)
                break; // coding makes none better
            TESSERA_TRY(try_out(candidate, bytes));
            if (candidate.error < least)
                best = &candidate;
        }
        if (best == nullptr)
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

    // Finds `ideal` of all, in the same patches, so that chance favours none.
    Status compare_means(std::vector<Candidate>& candidates) const {
        const std::uint64_t tiles = texture_.grid().tiles();
        std::vector<std::vector<ErrorSum>> sums(std::min<std::uint64_t>(patches, tiles),
                                                std::vector<ErrorSum>(candidates.size()));
        std::vector<Patch> workers(thread_count(plan_.options.threads));
        TESSERA_TRY(parallel_for(
            workers, sums.size(),
            [&](Patch& patch, std::size_t i) -> Status {
                TESSERA_TRY(read_patch(texture_, golden_pick(i, tiles), patch));
                for (std::size_t c = 0; c < candidates.size(); ++c)
                    add_error(patch, candidates[c].entry, texture_.desc(), sums[i][c]);
                return {};
            },
            [](std::size_t) {}));
        for (std::size_t c = 0; c < candidates.size(); ++c) {
            ErrorSum all;
            for (const std::vector<ErrorSum>& sum : sums) {
                all.squared_error += sum[c].squared_error;
                all.samples += sum[c].samples;
            }
            candidates[c].ideal = all.squared_error / all.samples;
        }
        return {};
    }

    // Some tiles of the level, and the share of its texels that they have.
    Result<Sample> take_sample(LevelCoder& level, double& share) const {
        Sample sample;
        const TileGrid& grid = level.plan.grid;
        const std::uint64_t tiles = grid.tiles();
        const std::size_t reads = texture_.grid().tiles() / tiles + 1; // of one tile, about
        const std::size_t wanted = std::min<std::uint64_t>(
            tiles, std::clamp(trial_reads / reads, fewest_trial_tiles, trial_tiles));
        for (std::size_t i = 0; i < wanted; ++i)
            sample.boxes.push_back(grid.box(wanted == tiles ? i : golden_pick(i, tiles)));
        sample.tiles.resize(wanted);
        std::vector<int> workers(thread_count(plan_.options.threads));
        TESSERA_TRY(parallel_for(
            workers, wanted,
            [&](int, std::size_t i) -> Status {
                const Box4& box = sample.boxes[i];
                std::vector<std::byte>& texels = sample.tiles[i].texels;
                texels.resize(static_cast<std::size_t>(level.plan.colour.desc.box_bytes(box)));
                return level.source.read(box, texels);
            },
            [](std::size_t) {}));
        share = static_cast<double>(sample.texel_count()) /
                static_cast<double>(texel_count(grid.size()));
        return sample;
    }

    // Finds the smallest step shift that fits and the error that remains.
    Status try_out(Candidate& candidate, double bytes) {
        LevelCoder level(plan_, texture_, candidate.entry);
        double share = 0;
        TESSERA_TRY_ASSIGN(const Sample sample, take_sample(level, share));
        const double tiles = static_cast<double>(level.plan.grid.tiles());
        const double samples = share * static_cast<double>(texel_count(candidate.entry.size)) *
                               level.plan.colour.desc.channels;
        for (unsigned first = 0, end = largest_shift + 1; first < end;) {
            const unsigned shift = (first + end) / 2;
            const Result<CodingParameters> parameters = with_coarser_steps(pass_.parameters, shift);
            if (!parameters) { // the steps cannot be so coarse
                end = shift;
                continue;
            }
            TESSERA_TRY_ASSIGN(const PassResult coded, run_pass(level.plan, *parameters, sample));
            const double size =
                static_cast<double>(coded.payload_bytes()) / share + index_bytes * tiles;
            if (size > bytes) {
                first = shift + 1;
                continue;
            }
            candidate.entry.step_shift = static_cast<std::uint8_t>(shift);
            candidate.error = candidate.ideal + coded.totals.squared_error / samples;
            end = shift;
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
            TESSERA_TRY_ASSIGN(PassResult coded,
                               run_pass(level.plan, *parameters, 0, "coarse levels"));
            CoarseLevel result{entry, std::move(coded.tiles), std::move(coded.payloads)};
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
        TESSERA_TRY_ASSIGN(auto level,
                           chooser.next(finer, share * static_cast<double>(pass.payload_bytes())));
        if (!level)
            continue;
        finer = level->entry;
        levels.push_back(std::move(*level));
    }
    return levels;
}

} // namespace tessera
