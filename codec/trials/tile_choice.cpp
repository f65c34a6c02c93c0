#include "codec/trials/tile_choice.h"

#include "codec/texels/sample_tiles.h"
#include "codec/trials/tile_shapes.h"
#include "codec/trials/trial_plan.h"
#include "format/texture.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace tessera {
namespace {

// With more short tiles, the root of the index would not fit into the first 8 KiB of a file, and a
// texel could no longer be read in three reads: the head, a record of the index and a page.
constexpr std::uint64_t most_short_tiles = std::uint64_t{1} << 17;
constexpr std::uint64_t fewest_patches = 2, most_compared_patches = 16;
constexpr std::uint64_t fewest_patches_by_estimate = 1;
constexpr std::uint64_t most_patch_bytes = 24u << 20; // of those that are read
constexpr std::uint32_t smallest_side = 32;           // smaller textures are not worth a trial
constexpr int most_effort_of_trial = 4;

// A first trial at quick_effort_of_trial takes a third of the time of a full one, but favours many
// views by up to 8 % of the costs. Ratios of costs between these bounds need a full trial
// (codec/DECISIONS.md, "Efforts").
struct Unclear {
    double from, to;
};
constexpr Unclear unclear_of_more_views{0.92, 1.02}, unclear_of_fewer_views{0.98, 1.035};
constexpr Unclear unclear_of_even_more{0.92, 1}; // after a first step to more views
// In textures of so many times the compared patches a full trial takes little of the encoding time.
constexpr std::uint64_t large_of_patches = 16;
constexpr Unclear unclear_of_fewer_of_large{0.98, 1.09};

// How much neighbouring texels that matter differ.
std::uint64_t liveliness(const TileTexels& tile, std::size_t texel_bytes) {
    const std::span<const std::byte> texels = tile.texels;
    const auto changes = [](std::span<const std::byte> from, std::span<const std::byte> to) {
        std::uint32_t sum = 0; // enough for a tile's bytes, and quicker than 64 bits
        for (std::size_t i = 0; i < to.size(); ++i)
            sum += from[i] != to[i];
        return std::uint64_t{sum};
    };
    if (tile.matters.empty())
        return changes(texels, texels.subspan(texel_bytes));
    std::uint64_t sum = 0;
    for (std::size_t i = 1; i < texels.size() / texel_bytes; ++i)
        if (!tile.is_free(i) && !tile.is_free(i - 1))
            sum += changes(texels.subspan((i - 1) * texel_bytes, texel_bytes),
                           texels.subspan(i * texel_bytes, texel_bytes));
    return sum;
}

// The smallest patch that holds whole tiles of both shapes.
Extent4 patch_of(const Extent4& a, const Extent4& b) {
    Extent4 patch = a;
    for (std::size_t axis = 0; axis < 4; ++axis)
        patch[axis] = std::max(a[axis], b[axis]);
    return patch;
}

// Parts of the texture: the liveliest half of those that are read, as the rest may be background.
Result<Sample> read_patches(const EncodePlan& plan, const Extent4& extent) {
    EncodePlan cut = plan;
    cut.grid = TileGrid(plan.colour.desc.size, extent);
    const std::size_t texel_bytes = plan.colour.desc.texel_bytes();
    const std::uint64_t affordable = most_patch_bytes / (2 * texel_count(extent) * texel_bytes);
    const bool quick = plan.effort.quick;
    const std::uint64_t fewest = quick ? fewest_patches_by_estimate : fewest_patches;
    const std::uint64_t wanted = std::clamp(cut.grid.tiles() / (quick ? 32 : 16), fewest,
                                            std::clamp(affordable, fewest, most_compared_patches));
    TESSERA_TRY_ASSIGN(Sample sample, read_sample(cut, 2 * wanted));
    std::vector<std::uint64_t> lively;
    for (const TileTexels& tile : sample.tiles)
        lively.push_back(liveliness(tile, texel_bytes));
    Sample patches;
    for (const std::size_t i : largest_values(lively, wanted)) {
        patches.boxes.push_back(sample.boxes[i]);
        patches.tiles.push_back(std::move(sample.tiles[i]));
    }
    return patches;
}

// Cuts the patches into tiles of at most an extent, which it adds to `tiles`.
void cut_into_tiles(const Sample& patches, const Extent4& tile_extent, const TextureDesc& desc,
                    Sample& tiles) {
    for (std::size_t i = 0; i < patches.boxes.size(); ++i) {
        const Box4& patch = patches.boxes[i];
        const TileGrid grid(patch.extent(), tile_extent);
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
            Box4 box = grid.box(tile);
            for (std::size_t axis = 0; axis < 4; ++axis) {
                box.begin[axis] += patch.begin[axis];
                box.end[axis] += patch.begin[axis];
            }
            TileTexels& part = tiles.tiles.emplace_back();
            part.texels.resize(desc.box_bytes(box));
            copy_box(box, patch, patches.tiles[i].texels, box, part.texels, desc.texel_bytes());
            if (!patches.tiles[i].matters.empty()) {
                part.matters.resize(box.texels());
                copy_box(box, patch, patches.tiles[i].matters, box, part.matters, 1);
                forget_needless_mask(part.matters);
            }
            tiles.boxes.push_back(box);
        }
    }
}

// The cost of the patches in tiles of `other` over their cost in tiles of `usual`.
Result<double> cost_ratio(const EncodePlan& plan, const Sample& patches, int effort,
                          const Extent4& other, const Extent4& usual) {
    const EncodePlan trial = plan_of_trial(plan, patches, effort);
    const auto cost_in = [&](const Extent4& extent) -> Result<double> {
        Sample tiles;
        cut_into_tiles(patches, extent, plan.colour.desc, tiles);
        TESSERA_TRY_ASSIGN(const PassResult pass,
                           run_pass(trial, parameters_of_trial(trial), tiles));
        return lagrangian_cost(trial, pass);
    };
    TESSERA_TRY_ASSIGN(const double cost, cost_in(other));
    TESSERA_TRY_ASSIGN(const double usual_cost, cost_in(usual));
    return usual_cost > 0 ? cost / usual_cost : 1;
}

// The same by the estimates of the block search. At quick efforts passes over the patches would be
// two fifths of the encode.
Result<double> estimated_ratio(const EncodePlan& plan, const Sample& patches, const Extent4& other,
                               const Extent4& usual) {
    const EncodePlan trial = plan_of_trial(plan, patches, plan.options.effort);
    Sample tiles;
    cut_into_tiles(patches, other, plan.colour.desc, tiles);
    const auto others = static_cast<std::ptrdiff_t>(tiles.tiles.size());
    cut_into_tiles(patches, usual, plan.colour.desc, tiles);
    TESSERA_TRY_ASSIGN(const std::vector<float> costs,
                       estimated_costs(trial, parameters_of_trial(trial), tiles));
    const double cost = std::accumulate(costs.begin(), costs.begin() + others, 0.0);
    const double usual_cost = std::accumulate(costs.begin() + others, costs.end(), 0.0);
    return usual_cost > 0 ? cost / usual_cost : 1;
}

const Unclear& unclear_ratios(const Extent4& other, const Extent4& usual, bool is_first_step,
                              bool is_large) {
    const auto views = [](const Extent4& tile) { return tile[axis_s] * tile[axis_t]; };
    if (views(other) < views(usual))
        return is_large ? unclear_of_fewer_of_large : unclear_of_fewer_views;
    return is_first_step ? unclear_of_more_views : unclear_of_even_more;
}

// Whether parts of the texture code better in tiles of `other` than of `usual`.
Result<bool> is_better(const EncodePlan& plan, const Extent4& other, const Extent4& usual,
                       bool is_first_step) {
    // With layers the patches are as large as wide tiles would need.
    const Extent4& smallest = plan.options.layers ? wide_tile : usual;
    TESSERA_TRY_ASSIGN(Sample patches,
                       read_patches(plan, patch_of(patch_of(usual, other), smallest)));
    const EncodePlan green = keep_green(plan, patches);
    if (plan.effort.quick) {
        TESSERA_TRY_ASSIGN(const double ratio, estimated_ratio(green, patches, other, usual));
        return ratio < 1;
    }
    const auto ratio_at = [&](int most_effort) {
        return cost_ratio(green, patches, std::min(plan.options.effort, most_effort), other, usual);
    };
    TESSERA_TRY_ASSIGN(double ratio, ratio_at(quick_effort_of_trial));
    const bool is_large = texel_count(plan.colour.desc.size) >=
                          large_of_patches * patches.boxes.size() * patches.boxes[0].texels();
    const Unclear& unclear = unclear_ratios(other, usual, is_first_step, is_large);
    if (plan.options.effort > quick_effort_of_trial && ratio > unclear.from && ratio < unclear.to) {
        TESSERA_TRY_ASSIGN(ratio, ratio_at(most_effort_of_trial));
    }
    return ratio < 1;
}

bool needs_no_trial(const EncodePlan& plan) {
    const Extent4& size = plan.colour.desc.size;
    // With a maximum error most bits code noise, which costs the same in any shape.
    return size[axis_u] <= smallest_side || size[axis_v] <= smallest_side ||
           plan.options.rate.kind == RateTarget::Kind::max_error ||
           (plan.options.layers && TileGrid(size, short_tile).tiles() > most_short_tiles);
}

} // namespace

Result<Extent4> choose_tile_extent(const EncodePlan& plan) {
    if (plan.options.tile_extent != tile_by_trial)
        return plan.options.tile_extent;
    const TileShapes shapes = tile_shapes(plan.colour.desc.size, plan.options);
    std::size_t best = shapes.usual;
    if (needs_no_trial(plan))
        return shapes.tiles[best];
    // Large tiles are for views of cameras. On spheres and meshes, whose tiles are decoded as they
    // come into view, tiles stay small.
    if (plan.parallax.on && !plan.options.layers)
        return large_tile(plan.colour.desc.size);
    // Steps to more views while that pays, else to fewer. A step compares two neighbours, because
    // these share small patches.
    for (const int step : {-1, 1}) {
        for (;;) {
            const std::size_t next = best + static_cast<std::size_t>(step);
            if (next >= shapes.tiles.size()) // also after a step below 0
                break;
            TESSERA_TRY_ASSIGN(
                const bool better,
                is_better(plan, shapes.tiles[next], shapes.tiles[best], best == shapes.usual));
            if (!better)
                break;
            best = next;
        }
        if (best != shapes.usual)
            break;
    }
    return shapes.tiles[best];
}

} // namespace tessera
