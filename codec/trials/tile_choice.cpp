#include "codec/trials/tile_choice.h"

#include "codec/pass/steps.h"
#include "codec/texels/sample_tiles.h"
#include "codec/trials/background.h"
#include "format/texture.h"

#include <algorithm>

namespace tessera {
namespace {

// More would not leave the root of the index room in the first 8 KiB of a file: any texel could no
// longer be read in three reads, the head, a record of the index and a page.
constexpr std::uint64_t most_short_tiles = std::uint64_t{1} << 17;
// What all shapes divide; the trial looks at such parts.
constexpr Extent4 patch_extent{64, 64, 8, 8};
constexpr std::uint64_t fewest_patches = 4, most_patches = 16;
constexpr std::uint64_t most_patch_bytes = 24u << 20; // of those that are read
static_assert(most_patch_bytes >= 2 * fewest_patches * texel_count(patch_extent) * 8);
constexpr int most_effort_of_trial = 4;
constexpr double quality_of_trial = 58; // where the rate is a target, not a step

// How much texels that matter change from one to the next.
std::uint64_t liveliness(const TileTexels& tile, std::size_t texel_bytes) {
    const std::vector<std::byte>& texels = tile.texels;
    std::uint64_t sum = 0;
    for (std::size_t i = texel_bytes; i < texels.size(); ++i)
        if (const std::size_t texel = i / texel_bytes;
            !tile.is_free(texel) && !tile.is_free(texel - 1))
            sum += texels[i] != texels[i - texel_bytes];
    return sum;
}

// Parts of the texture, the liveliest of twice as many: the others are nearly all background.
Result<Sample> read_patches(const EncodePlan& plan) {
    EncodePlan cut = plan;
    cut.grid = TileGrid(plan.colour.desc.size, patch_extent);
    const std::uint64_t affordable =
        most_patch_bytes / (2 * texel_count(patch_extent) * plan.colour.desc.texel_bytes());
    const std::uint64_t wanted =
        std::clamp(cut.grid.tiles() / 16, fewest_patches, std::min(most_patches, affordable));
    TESSERA_TRY_ASSIGN(Sample sample, read_sample(cut, 2 * wanted));
    std::vector<std::uint64_t> lively;
    for (const TileTexels& tile : sample.tiles)
        lively.push_back(liveliness(tile, plan.colour.desc.texel_bytes()));
    Sample patches;
    for (const std::size_t i : largest_values(lively, wanted)) {
        patches.boxes.push_back(sample.boxes[i]);
        patches.tiles.push_back(std::move(sample.tiles[i]));
    }
    return patches;
}

Sample cut_into_tiles(const Sample& patches, const Extent4& tile_extent, const TextureDesc& desc) {
    Sample sample;
    for (std::size_t i = 0; i < patches.boxes.size(); ++i) {
        const Box4& patch = patches.boxes[i];
        const TileGrid grid(patch.extent(), tile_extent);
        for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile) {
            Box4 box = grid.box(tile);
            for (std::size_t axis = 0; axis < 4; ++axis) {
                box.begin[axis] += patch.begin[axis];
                box.end[axis] += patch.begin[axis];
            }
            TileTexels& part = sample.tiles.emplace_back();
            part.texels.resize(desc.box_bytes(box));
            copy_box(box, patch, patches.tiles[i].texels, box, part.texels, desc.texel_bytes());
            if (!patches.tiles[i].matters.empty()) {
                part.matters.resize(box.texels());
                copy_box(box, patch, patches.tiles[i].matters, box, part.matters, 1);
                forget_needless_mask(part.matters);
            }
            sample.boxes.push_back(box);
        }
    }
    return sample;
}

} // namespace

Result<Extent4> choose_tile_extent(const EncodePlan& plan) {
    if (plan.options.tile_extent != tile_by_trial)
        return plan.options.tile_extent;
    const TextureDesc& desc = plan.colour.desc;
    const Extent4& other_tile = plan.options.layers ? short_tile : wide_tile;
    // With corrections hardly anything but noise is left to code, in whatever shape.
    if (desc.size[axis_u] <= usual_tile[axis_u] || desc.size[axis_v] <= usual_tile[axis_v] ||
        plan.options.rate.kind == RateTarget::Kind::max_error ||
        (plan.options.layers && TileGrid(desc.size, short_tile).tiles() > most_short_tiles))
        return usual_tile;
    TESSERA_TRY_ASSIGN(const Sample patches, read_patches(plan));

    EncodePlan trial = plan;
    trial.colour.background = find_background(patches, desc);
    trial.effort =
        EffortSettings::of(std::min(plan.options.effort, most_effort_of_trial), plan.tools);
    const RateTarget& rate = plan.options.rate;
    const CodingParameters parameters = coding_parameters(
        step_of_quality(rate.kind == RateTarget::Kind::quality ? rate.value : quality_of_trial,
                        desc.type),
        trial);
    Extent4 best = usual_tile;
    double least = 0;
    for (const Extent4& extent : {usual_tile, other_tile}) {
        TESSERA_TRY_ASSIGN(const PassResult pass,
                           run_pass(trial, parameters, cut_into_tiles(patches, extent, desc)));
        const double cost = lagrangian_cost(trial, pass);
        if (extent == usual_tile || cost < least) {
            least = cost;
            best = extent;
        }
    }
    return best;
}

} // namespace tessera
