#include "codec/trials/alignment_choice.h"

#include "codec/texels/aligned_texels.h"
#include "codec/trials/base_trial.h"
#include "codec/trials/motion_patch.h"
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

constexpr int block_side = 8, farthest = 16; // texels; of parallax from one view to the next
// What is left to move from view to view, weighed by detail, over what moved before. Of what is to gain, edges
// of views that are cut by the grid take a part back.
constexpr double least_motion_left = 0.6;
// What differs between neighbouring views whose blocks are moved along the other axes, over what does along their
// own: 1.1 to 17 of light fields, 0.94 to 1.3 of baked textures.
constexpr double least_difference_transposed = 0.8;
constexpr std::size_t patches_of_order = 4;

// From one view to the next along `angular`, what views show moves along `spatial`.
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
    // Matches blocks of neighbouring views. Those that fit best as far as is looked may be anywhere.
    void add(const MotionPatch& patch, const Path& path) {
        const int side = patch.side(path.spatial);
        const int reach = std::min(farthest, (side - block_side) / 2);
        for (int view = 0; view + 1 < patch.side(path.angular); ++view)
            for (int a = std::max(reach, 0); a + block_side + reach <= side; a += block_side)
                for (int b = 0; b + block_side <= patch.side(path.across()); b += block_side)
                    add_block(patch, path, reach, a, b, view, patch.side(path.other()) / 2);
    }
    // Of all blocks where they fit best.
    double difference() const { return difference_; }
    // What is left to move, times its detail, where views are moved by so much.
    double left(int by) const {
        double sum = 0;
        for (int d = -farthest; d <= farthest; ++d)
            sum += weight_[static_cast<std::size_t>(d + farthest)] * std::abs(d + by);
        return sum;
    }

private:
    void add_block(const MotionPatch& patch, const Path& path, int reach, int along, int across,
                   int view, int other_view) {
        for (int a = along; a < along + block_side; ++a)
            for (int b = across; b < across + block_side; ++b)
                if (patch.is_free(path.place(a, b, view, other_view)))
                    return;
        std::int64_t least = -1, detail = 0;
        int best = 0;
        for (int d = -reach; d <= reach; ++d) {
            std::int64_t difference = 0;
            for (int a = along; a < along + block_side; ++a)
                for (int b = across; b < across + block_side; ++b)
                    difference += std::abs(patch.at(path.place(a, b, view, other_view)) -
                                           patch.at(path.place(a + d, b, view + 1, other_view)));
            // Of those that fit alike the shortest.
            if (least < 0 || difference < least ||
                (difference == least && std::abs(d) < std::abs(best))) {
                least = difference;
                best = d;
            }
        }
        difference_ += static_cast<double>(least);
        if (std::abs(best) == reach)
            return;
        for (int a = along; a < along + block_side; ++a)
            for (int b = across; b < across + block_side; ++b)
                detail += std::abs(patch.at(path.place(a, b, view, other_view)) -
                                   patch.at(path.place(a - 1, b, view, other_view)));
        weight_[static_cast<std::size_t>(best + farthest)] += static_cast<double>(detail);
    }

    std::array<double, 2 * farthest + 1> weight_{};
    double difference_ = 0;
};

bool may_be_aligned(const EncodePlan& plan) {
    const TextureDesc& desc = plan.colour.desc;
    return plan.effort.try_alignment && !plan.options.layers &&
           plan.options.description.proxy == Proxy::none &&
           (desc.size[axis_s] > 1 || desc.size[axis_t] > 1) &&
           (plan.source.locality() == Locality::any ||
            desc.box_bytes(Box4::whole(desc.size)) <= plan.options.slab_bytes / 2);
}

// What is along s and what is along t.
struct ViewMotions {
    Path path_s, path_t;
    Motion of_s{}, of_t{};

    void add(std::span<const MotionPatch> patches) {
        for (const MotionPatch& patch : patches) {
            of_s.add(patch, path_s);
            of_t.add(patch, path_t);
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

} // namespace

Result<ViewMotion> motion_between_views(const EncodePlan& plan) {
    ViewMotion motion;
    const bool aligns = may_be_aligned(plan), has_bases = may_have_base_pictures(plan);
    if (!aligns && !has_bases)
        return motion;
    TESSERA_TRY_ASSIGN(const std::vector<MotionPatch> patches, read_motion_patches(plan));
    if (aligns) {
        const auto few = std::span(patches).first(std::min(patches.size(), patches_of_order));
        ViewMotions straight{{axis_u, axis_s}, {axis_v, axis_t}};
        ViewMotions transposed{{axis_v, axis_s}, {axis_u, axis_t}};
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

namespace {

constexpr std::uint64_t parts_of_trial = 12;

// What parts of the texture cost, a texel that matters. `boxes` are of the texture: aligned, they are those that
// show the same in the middle of their views.
Result<double> cost_of_parts(const EncodePlan& plan, TexelSource& source, const AlignedViews& views,
                             const std::vector<Box4>& boxes) {
    const auto texels = texels_in_grid(source, views), mask = mask_of_grid(plan.mask, views);
    EncodePlan cut = plan;
    cut.views = views;
    cut.colour.desc.size = views.grid_size();
    Sample sample;
    for (Box4 box : boxes) {
        const std::uint32_t u = views.shift_u((box.begin[axis_s] + box.end[axis_s] - 1) / 2);
        const std::uint32_t v = views.shift_v((box.begin[axis_t] + box.end[axis_t] - 1) / 2);
        for (std::uint32_t* corner : {box.begin.data(), box.end.data()}) {
            corner[axis_u] += u;
            corner[axis_v] += v;
        }
        TESSERA_TRY_ASSIGN(TileTexels tile, read_finite(*texels, mask.get(), box));
        sample.boxes.push_back(box);
        sample.tiles.push_back(std::move(tile));
    }
    const EncodePlan trial =
        plan_of_trial(cut, sample, std::min(plan.options.effort, quick_effort_of_trial));
    TESSERA_TRY_ASSIGN(const PassResult pass, run_pass(trial, parameters_of_trial(trial), sample));
    return lagrangian_cost(trial, pass) / static_cast<double>(sample.texels_that_matter());
}

} // namespace

Result<bool> alignment_pays(const EncodePlan& plan, TexelSource& source, ViewAlignment alignment) {
    const Extent4& size = plan.colour.desc.size;
    const Extent4& tile = plan.options.tile_extent;
    const TileShapes shapes =
        tile == tile_by_trial ? tile_shapes(size, plan.options) : TileShapes{{tile}, 0};
    const TileGrid grid(size, shapes.tiles[shapes.usual]);
    std::vector<Box4> boxes;
    const std::uint64_t tiles = grid.tiles();
    for (std::uint64_t i = 0; i < std::min(parts_of_trial, tiles); ++i)
        boxes.push_back(grid.box(tiles <= parts_of_trial ? i : golden_pick(i, tiles)));
    TESSERA_TRY(source.begin_slab(Box4::whole(size)));
    TESSERA_TRY_ASSIGN(const double aligned,
                       cost_of_parts(plan, source, AlignedViews(size, alignment), boxes));
    TESSERA_TRY_ASSIGN(const double plain,
                       cost_of_parts(plan, source, AlignedViews(size, {}), boxes));
    return aligned < plain;
}

} // namespace tessera
