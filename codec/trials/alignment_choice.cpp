#include "codec/trials/alignment_choice.h"

#include "codec/pass/tile_reading.h"
#include "codec/texels/aligned_texels.h"
#include "codec/trials/parallax.h"
#include "codec/trials/tile_shapes.h"
#include "codec/trials/trial_plan.h"
#include "format/levels.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <vector>

namespace tessera {
namespace {

constexpr Extent4 patch_extent{64, 64, 3, 3};
constexpr std::uint64_t most_patches = 16;
constexpr std::size_t patches_of_order = 4; // that decide whether views look transposed
constexpr std::uint64_t parts_of_trial = 12;
// Aligned views need more tiles, which parts of equal size do not show. So textures of so few tiles
// with base pictures are compared as a whole.
constexpr std::uint64_t most_tiles_of_whole = 16;
constexpr std::uint8_t margin_of_trial = 4;  // texels, of base pictures
constexpr double least_gain_of_whole = 0.01; // aligned views take more time
constexpr int block_side = 8, farthest = 16; // texels; of parallax from one view to the next
// An alignment must reduce the motion, weighted by detail, to this share. The edges of the views,
// which it moves across tiles, cost a part of the gain.
constexpr double least_motion_left = 0.6;
// The views look transposed if matching along the other axes leaves less than this share of the
// difference. The ratio is 1.1 to 17 for light fields, 0.94 to 1.3 for baked textures.
constexpr double least_difference_transposed = 0.8;

Result<std::vector<MotionPatch>> read_motion_patches(const EncodePlan& plan) {
    EncodePlan cut = plan;
    cut.grid = TileGrid(plan.colour.desc.size, patch_extent);
    TESSERA_TRY_ASSIGN(const Sample sample, read_sample(cut, most_patches));
    std::vector<MotionPatch> patches;
    for (std::size_t i = 0; i < sample.boxes.size(); ++i)
        patches.emplace_back(sample.boxes[i], sample.tiles[i], plan.colour.desc);
    return patches;
}

// From one view to the next along `angular`, what the views show moves along `spatial`.
struct Path {
    Axis spatial, angular;
    Axis across() const { return spatial == axis_u ? axis_v : axis_u; }
    Axis other() const { return angular == axis_s ? axis_t : axis_s; }

    MotionPatch::Place place(int along, int beside, int view, int other_view) const {
        MotionPatch::Place place{};
        place[spatial] = along;
        place[across()] = beside;
        place[angular] = view;
        place[other()] = other_view;
        return place;
    }
};

// How much detail moves by how many texels along one axis, from one view to the next.
class Motion {
public:
    explicit Motion(const Path& path) : path_(path) {}

    // Matches the blocks of neighbouring views.
    void add(const MotionPatch& patch) {
        const int side = patch.side(path_.spatial);
        const int reach = std::min(farthest, (side - block_side) / 2);
        for (int view = 0; view + 1 < patch.side(path_.angular); ++view)
            for (int a = std::max(reach, 0); a + block_side + reach <= side; a += block_side)
                for (int b = 0; b + block_side <= patch.side(path_.across()); b += block_side)
                    add_block(patch, reach, a, b, view);
    }
    // The sum of all blocks' differences from their best matches.
    double difference() const { return difference_; }
    // The motion that is left, weighted by detail, if views are moved by this many texels.
    double left(int by) const {
        double sum = 0;
        for (int d = -farthest; d <= farthest; ++d)
            sum += weight_[d + farthest] * std::abs(d + by);
        return sum;
    }

private:
    void add_block(const MotionPatch& patch, int reach, int along, int across, int view) {
        const int other_view = patch.side(path_.other()) / 2;
        // The sum of visit(a, b) over the block's texels.
        const auto sum_over = [&](const auto& visit) {
            std::int64_t sum = 0;
            for (int a = along; a < along + block_side; ++a)
                for (int b = across; b < across + block_side; ++b)
                    sum += visit(a, b);
            return sum;
        };
        const auto at = [&](int a, int b, int of_view) {
            return patch.at(path_.place(a, b, of_view, other_view));
        };
        if (sum_over([&](int a, int b) {
                return patch.is_free(path_.place(a, b, view, other_view));
            }) > 0)
            return;
        std::int64_t least = -1;
        int best = 0;
        for (int d = -reach; d <= reach; ++d) {
            const std::int64_t difference = sum_over(
                [&](int a, int b) { return std::abs(at(a, b, view) - at(a + d, b, view + 1)); });
            // Of equal matches the shortest.
            if (least < 0 || difference < least ||
                (difference == least && std::abs(d) < std::abs(best))) {
                least = difference;
                best = d;
            }
        }
        difference_ += static_cast<double>(least);
        if (std::abs(best) == reach)
            return; // the true match may lie farther away
        weight_[best + farthest] += static_cast<double>(
            sum_over([&](int a, int b) { return std::abs(at(a, b, view) - at(a - 1, b, view)); }));
    }

    Path path_;
    std::array<double, 2 * farthest + 1> weight_{};
    double difference_ = 0;
};

// Motion along s and along t.
struct ViewMotions {
    Motion of_s, of_t;

    void add(std::span<const MotionPatch> patches) {
        for (const MotionPatch& patch : patches) {
            of_s.add(patch);
            of_t.add(patch);
        }
    }
    double difference() const { return of_s.difference() + of_t.difference(); }
};

ViewAlignment alignment_by(const Motion& along_u, const Motion& along_v) {
    // Cameras are as far apart along s as along t, and base pictures need them to stay so.
    ViewAlignment best;
    double least = least_motion_left * (along_u.left(0) + along_v.left(0));
    for (int u = -farthest; u <= farthest; ++u)
        for (const int v : {u, -u})
            if (const double left = along_u.left(u) + along_v.left(v); left < least) {
                least = left;
                best = {static_cast<std::int8_t>(u), static_cast<std::int8_t>(v)};
            }
    return best;
}

// Surfaces have no views that differ by parallax only. All layers of a file lie on its mesh, which
// the first one alone has.
bool may_be_views(const EncodePlan& plan) {
    const Extent4& size = plan.colour.desc.size;
    const Description& description = plan.options.description;
    return description.proxy == Proxy::none && description.surface_map != SurfaceMap::mesh_uv &&
           (size[axis_s] > 1 || size[axis_t] > 1);
}

bool may_be_aligned(const EncodePlan& plan) {
    const TextureDesc& desc = plan.colour.desc;
    return plan.effort.try_alignment && !plan.options.layers && may_be_views(plan) &&
           (plan.source.locality() == Locality::any ||
            desc.box_bytes(Box4::whole(desc.size)) <= plan.options.slab_bytes / 2);
}

// The plan, without its tiles, for views that are moved so.
EncodePlan plan_for(const EncodePlan& plan, const AlignedViews& views) {
    EncodePlan of_views = plan;
    of_views.views = views;
    of_views.colour.desc.size = views.grid_size();
    return of_views;
}

// `boxes` are of the grid of these views.
Result<Sample> read_boxes(const EncodePlan& plan, TexelSource& source, const AlignedViews& views,
                          const std::vector<Box4>& boxes) {
    const auto texels = texels_in_grid(source, views), mask = mask_of_grid(plan.mask, views);
    Sample sample;
    for (const Box4& box : boxes) {
        TESSERA_TRY_ASSIGN(TileTexels tile, read_finite(*texels, mask.get(), box));
        sample.boxes.push_back(box);
        sample.tiles.push_back(std::move(tile));
    }
    return sample;
}

// The cost of the sample per texel that matters.
Result<double> cost_of(const EncodePlan& plan, const Sample& sample, const BasePictures& base) {
    const EncodePlan trial =
        plan_of_trial(plan, sample, std::min(plan.options.effort, quick_effort_of_trial));
    CodingParameters parameters = parameters_of_trial(trial);
    parameters.base = base;
    TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(trial, parameters, sample));
    return lagrangian_cost(trial, pass) / static_cast<double>(sample.texels_that_matter());
}

// The cost of parts of the texture, without base pictures. `boxes` are of the texture; in aligned
// views they move with the middle of their views.
Result<double> cost_of_parts(const EncodePlan& plan, TexelSource& source, const AlignedViews& views,
                             std::vector<Box4> boxes) {
    for (Box4& box : boxes) {
        const std::uint32_t u = views.shift_u((box.begin[axis_s] + box.end[axis_s] - 1) / 2);
        const std::uint32_t v = views.shift_v((box.begin[axis_t] + box.end[axis_t] - 1) / 2);
        for (std::uint32_t* corner : {box.begin.data(), box.end.data()}) {
            corner[axis_u] += u;
            corner[axis_v] += v;
        }
    }
    TESSERA_TRY_ASSIGN(const Sample sample, read_boxes(plan, source, views, boxes));
    return cost_of(plan_for(plan, views), sample, {});
}

TileGrid grid_of_large_tiles(const AlignedViews& views) {
    const Extent4 size = views.grid_size();
    return {size, large_tile(size)};
}

// All of the texture in large tiles, in green.
struct WholeTexture {
    Sample sample;
    EncodePlan plan;
};

Result<WholeTexture> read_whole(const EncodePlan& plan, TexelSource& source,
                                const AlignedViews& views) {
    const TileGrid grid = grid_of_large_tiles(views);
    std::vector<Box4> boxes;
    for (std::uint64_t tile = 0; tile < grid.tiles(); ++tile)
        boxes.push_back(grid.box(tile));
    TESSERA_TRY_ASSIGN(Sample sample, read_boxes(plan, source, views, boxes));
    EncodePlan green = keep_green(plan_for(plan, views), sample);
    return WholeTexture{.sample = std::move(sample), .plan = std::move(green)};
}

// Whether the whole texture costs less with the alignment, with base pictures in both cases. Those
// of views that stand still need a margin more often.
Result<bool> alignment_pays_on_whole(const EncodePlan& plan, TexelSource& source,
                                     const AlignedViews& still, const AlignedViews& moved,
                                     BasePictures base) {
    TESSERA_TRY_ASSIGN(const WholeTexture aligned, read_whole(plan, source, moved));
    TESSERA_TRY_ASSIGN(const double aligned_cost, cost_of(aligned.plan, aligned.sample, base));
    const auto is_less = [&](double plain_cost) {
        return aligned_cost < (1 - least_gain_of_whole) * plain_cost;
    };
    TESSERA_TRY_ASSIGN(const WholeTexture plain, read_whole(plan, source, still));
    TESSERA_TRY_ASSIGN(const double narrow, cost_of(plain.plan, plain.sample, base));
    if (!is_less(narrow))
        return false;
    base.margin = margin_of_trial;
    TESSERA_TRY_ASSIGN(const double wide, cost_of(plain.plan, plain.sample, base));
    return is_less(wide);
}

} // namespace

Result<ViewMotion> motion_between_views(const EncodePlan& plan) {
    ViewMotion motion;
    const bool aligns = may_be_aligned(plan);
    const bool has_bases = plan.effort.try_base && !plan.colour.corrections && may_be_views(plan);
    if (!aligns && !has_bases)
        return motion;
    TESSERA_TRY_ASSIGN(const std::vector<MotionPatch> patches, read_motion_patches(plan));
    if (aligns) {
        const auto few = std::span(patches).first(std::min(patches.size(), patches_of_order));
        ViewMotions straight{Motion({axis_u, axis_s}), Motion({axis_v, axis_t})};
        ViewMotions transposed{Motion({axis_v, axis_s}), Motion({axis_u, axis_t})};
        straight.add(few);
        transposed.add(few);
        motion.looks_transposed =
            transposed.difference() < least_difference_transposed * straight.difference();
        straight.add(std::span(patches).subspan(few.size()));
        motion.alignment = alignment_by(straight.of_s, straight.of_t);
    }
    if (has_bases)
        motion.parallax = parallax_in(patches, motion.alignment);
    return motion;
}

Result<bool> alignment_pays(const EncodePlan& plan, TexelSource& source, const ViewMotion& motion) {
    const Extent4& size = plan.colour.desc.size;
    const Extent4& tile = plan.options.tile_extent;
    const AlignedViews still(size, {}), moved(size, motion.alignment);
    TESSERA_TRY(source.begin_slab(Box4::whole(size)));
    if (motion.parallax.on && tile == tile_by_trial &&
        grid_of_large_tiles(still).tiles() <= most_tiles_of_whole)
        return alignment_pays_on_whole(plan, source, still, moved, motion.parallax);
    const TileShapes shapes =
        tile == tile_by_trial ? tile_shapes(size, plan.options) : TileShapes{{tile}, 0};
    const TileGrid grid(size, shapes.tiles[shapes.usual]);
    std::vector<Box4> boxes;
    const std::uint64_t tiles = grid.tiles();
    for (std::uint64_t i = 0; i < std::min(parts_of_trial, tiles); ++i)
        boxes.push_back(grid.box(tiles <= parts_of_trial ? i : golden_pick(i, tiles)));
    TESSERA_TRY_ASSIGN(const double aligned, cost_of_parts(plan, source, moved, boxes));
    TESSERA_TRY_ASSIGN(const double plain, cost_of_parts(plan, source, still, boxes));
    return aligned < plain;
}

} // namespace tessera
