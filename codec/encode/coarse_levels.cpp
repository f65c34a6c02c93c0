#include "codec/encode/coarse_levels.h"

#include "codec/pass/sample_pass.h"
#include "codec/pass/tile_figures.h"
#include "codec/reconstruct/tile_decoder.h"
#include "codec/texels/level_texels.h"
#include "format/texture.h"
#include "format/work.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>

namespace tessera {
namespace {

// Shares of the texture's payloads that the levels may take, finest first.
constexpr double level_share[] = {0.02, 0.003};
// A whole level may exceed its share by this factor, as its size was predicted from a sample.
constexpr double share_tolerance = 1.15;
constexpr unsigned largest_lod_step = 3; // beyond the finer level
constexpr unsigned largest_lod_sum = 4;  // spatial and angular; coarser levels show too little
constexpr unsigned largest_shift = 8;    // 2^8 times the step leaves a blur
// Patches of the texture in which candidates are compared. Patches of the candidate's own tiles
// took three times as long and made the choice depend on chance.
constexpr std::size_t patches = 16;
// Tiles of a candidate that are coded: fewer where each covers many tiles of the texture, so that
// about `trial_reads` of these are decoded.
constexpr std::size_t trial_tiles = 6, fewest_trial_tiles = 2, trial_reads = 256;
constexpr double index_bytes = 2; // per tile, about

constexpr double unusable = std::numeric_limits<double>::infinity();

// The texels that a pass's payloads decode to. Thread-safe; `plan` and `pass` outlive it.
class DecodedPass {
public:
    DecodedPass(const EncodePlan& plan, const PassResult& pass)
        : plan_(plan), pass_(pass),
          coding_(pass.parameters, plan.colour.desc.type, plan.colour.desc.channels) {}
    const TileGrid& grid() const { return plan_.grid; }
    const TextureDesc& desc() const { return plan_.colour.desc; }

    // Replaces `texels`. Errors: io, invalid_file.
    Status tile(std::uint64_t number, std::vector<std::byte>& texels) const {
        std::unique_ptr<TileDecoder> decoder;
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                decoder = std::move(idle_.back());
                idle_.pop_back();
            }
        }
        if (decoder == nullptr)
            decoder = std::make_unique<TileDecoder>(coding_, plan_.colour);
        const Box4 box = plan_.grid.box(number);
        std::vector<std::byte> payload;
        TESSERA_TRY(pass_.payloads->get(number, payload));
        texels.resize(desc().box_bytes(box));
        TESSERA_TRY(decoder->decode(payload, tile_shape(box), texels));
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(decoder));
        return {};
    }

private:
    const EncodePlan& plan_;
    const PassResult& pass_;
    const TileCoding coding_;
    mutable std::mutex mutex_;
    mutable std::vector<std::unique_ptr<TileDecoder>> idle_; // decoders that no thread uses
};

// A coarse level of the decoded texels. Thread-safe.
class LevelSource final : public TexelSource {
public:
    LevelSource(const DecodedPass& texture, const LevelEntry& entry)
        : texture_(texture), full_{texture.grid().size(), 0, 0, 0}, entry_(entry),
          desc_(texture.desc()) {
        desc_.size = entry.size;
    }
    const TextureDesc& desc() const override { return desc_; }
    Status read(const Box4& box, std::span<std::byte> out) override {
        LevelMeans means(desc_, full_, entry_, box);
        const TileGrid& grid = texture_.grid();
        std::vector<std::byte> texels;
        for (const std::uint64_t tile : grid.tiles_touched(covered_by(box, entry_, full_))) {
            TESSERA_TRY(texture_.tile(tile, texels));
            means.add(grid.box(tile), texels);
        }
        means.finish(out);
        return {};
    }

private:
    const DecodedPass& texture_;
    const LevelEntry full_, entry_;
    TextureDesc desc_;
};

// A level as the plan of a pass. The plan refers to `source`, so the object stays where it is.
struct LevelPlan {
    LevelPlan(const EncodePlan& whole, const DecodedPass& texture, const LevelEntry& level)
        : source(texture, level), plan{.source = source,
                                       .options = whole.options,
                                       .grid = TileGrid(level.size, whole.grid.tile_extent()),
                                       .colour = whole.colour,
                                       .effort = whole.effort,
                                       .tools = whole.tools} {
        plan.colour.desc.size = level.size;
        plan.colour.corrections = false; // a maximum error holds for the texture only
    }
    LevelPlan(const LevelPlan&) = delete;
    LevelPlan& operator=(const LevelPlan&) = delete;

    LevelSource source;
    EncodePlan plan;
};

struct Candidate {
    LevelEntry entry;
    double ideal = 0;        // mean squared error of the interpolated means, in codes
    double error = unusable; // the same after coding the means
};

// A part of the texture in which candidates are compared: two tiles along every axis, so that its
// middle can be interpolated.
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
    patch.texels.resize(texture.desc().box_bytes(box));
    std::vector<std::byte> texels;
    for (const std::uint64_t number : grid.tiles_touched(box)) {
        TESSERA_TRY(texture.tile(number, texels));
        const Box4 tile_box = grid.box(number), part = intersect(tile_box, box);
        copy_box(part, tile_box, texels, box, patch.texels, texture.desc().texel_bytes());
    }
    return {};
}

struct ErrorSum {
    double squared_error = 0; // of codes
    double samples = 0;
};

// Adds the error of the patch's middle when it is interpolated from means of 2^lods texels.
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

    // Codes the best level that is coarser than `finer` and takes at most `bytes`, if there is one.
    Result<std::optional<CoarseLevel>> next(const LevelEntry& finer, double bytes) {
        std::vector<Candidate> candidates = candidates_after(finer);
        TESSERA_TRY(compare_means(candidates));
        std::ranges::sort(candidates, {}, &Candidate::ideal);
        const Candidate* best = nullptr;
        for (Candidate& candidate : candidates) {
            const double least = best != nullptr ? best->error : unusable;
            if (candidate.ideal >= least)
                break; // coding only adds to the error
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
        const Extent4& size = plan_.grid.size();
        // Whether halving two axes once more still joins texels along one of them.
        const auto joins = [&size](Axis a, Axis b, unsigned lod) {
            return size[a] > 1u << (lod - 1) || size[b] > 1u << (lod - 1);
        };
        std::vector<Candidate> candidates;
        for (unsigned s = 0; s <= largest_lod_step; ++s)
            for (unsigned a = 0; a <= largest_lod_step; ++a) {
                const unsigned spatial = finer.spatial_lod + s, angular = finer.angular_lod + a;
                if (s + a > 0 && s + a <= largest_lod_sum &&
                    (s == 0 || joins(axis_u, axis_v, spatial)) &&
                    (a == 0 || joins(axis_s, axis_t, angular)))
                    candidates.push_back({coarse_level(size, spatial, angular, 0)});
            }
        return candidates;
    }

    // Sets `ideal` of all candidates. They share the patches, so that chance favours none.
    Status compare_means(std::vector<Candidate>& candidates) const {
        const std::uint64_t tiles = texture_.grid().tiles();
        std::vector<std::vector<ErrorSum>> sums(std::min<std::uint64_t>(patches, tiles),
                                                std::vector<ErrorSum>(candidates.size()));
        TESSERA_TRY(parallel_for(sums.size(), plan_.options.threads, [&](std::size_t i) -> Status {
            Patch patch;
            TESSERA_TRY(read_patch(texture_, golden_pick(i, tiles), patch));
            for (std::size_t c = 0; c < candidates.size(); ++c)
                add_error(patch, candidates[c].entry, texture_.desc(), sums[i][c]);
            return {};
        }));
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

    Result<Sample> take_sample(LevelPlan& level) const {
        const TileGrid& grid = level.plan.grid;
        const std::uint64_t tiles = grid.tiles();
        const std::size_t reads = texture_.grid().tiles() / tiles + 1; // per tile, about
        const std::size_t wanted = std::min<std::uint64_t>(
            tiles, std::clamp(trial_reads / reads, fewest_trial_tiles, trial_tiles));
        Sample sample;
        for (std::size_t i = 0; i < wanted; ++i)
            sample.boxes.push_back(grid.box(wanted == tiles ? i : golden_pick(i, tiles)));
        sample.tiles.resize(wanted);
        TESSERA_TRY(parallel_for(wanted, plan_.options.threads, [&](std::size_t i) {
            const Box4& box = sample.boxes[i];
            std::vector<std::byte>& texels = sample.tiles[i].texels;
            texels.resize(level.plan.colour.desc.box_bytes(box));
            return level.source.read(box, texels);
        }));
        return sample;
    }

    // Finds the smallest step shift with which the level fits into `bytes`, and its error.
    Status try_out(Candidate& candidate, double bytes) {
        LevelPlan level(plan_, texture_, candidate.entry);
        TESSERA_TRY_ASSIGN(const Sample sample, take_sample(level));
        const double texels = static_cast<double>(texel_count(candidate.entry.size));
        const double share = static_cast<double>(sample.texel_count()) / texels;
        const double tiles = static_cast<double>(level.plan.grid.tiles());
        const double samples = share * texels * level.plan.colour.desc.channels;
        for (unsigned first = 0, end = largest_shift + 1; first < end;) {
            const unsigned shift = (first + end) / 2;
            const Result<CodingParameters> parameters = with_coarser_steps(pass_.parameters, shift);
            if (!parameters) { // steps beyond what the format can say
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

    // Codes the whole level, with coarser steps if it turns out too large.
    Result<std::optional<CoarseLevel>> code(LevelEntry entry, double bytes) {
        for (;; ++entry.step_shift) {
            const Result<CodingParameters> parameters =
                with_coarser_steps(pass_.parameters, entry.step_shift);
            if (!parameters || entry.step_shift > largest_shift)
                return std::optional<CoarseLevel>();
            LevelPlan level(plan_, texture_, entry);
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
    const auto chooser = std::make_unique<LevelChooser>(plan, pass); // with tables: large
    std::vector<CoarseLevel> levels;
    LevelEntry finer{plan.grid.size(), 0, 0, 0};
    for (const double share : level_share) {
        TESSERA_TRY_ASSIGN(auto level,
                           chooser->next(finer, share * static_cast<double>(pass.payload_bytes())));
        if (!level)
            continue;
        finer = level->entry;
        levels.push_back(std::move(*level));
    }
    return levels;
}

} // namespace tessera
