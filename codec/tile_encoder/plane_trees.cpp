#include "codec/tile_encoder/plane_trees.h"

namespace tessera {

void join_planes(const std::array<TileLevels, plane_tree_count>& planes, TileLevels& out) {
    out.clear();
    out.shape = planes[0].shape;
    const auto append = [](const auto& items, auto& all) {
        all.insert(all.end(), items.begin(), items.end());
    };
    for (std::size_t plane = 0; plane < planes.size(); ++plane) {
        const TileLevels& own = planes[plane];
        out.second_tree = out.blocks.size();
        append(own.blocks, out.blocks);
        append(own.splits, out.splits);
        append(own.predictions, out.predictions);
        out.predictions.resize(out.blocks.size());
        for (const PlaneLevels& levels : own.planes)
            for (std::size_t other = 0; other < planes.size(); ++other) {
                PlaneLevels& put = out.planes.emplace_back();
                if (other == plane)
                    put = levels;
                put.first = static_cast<std::uint32_t>(out.nonzeros.size());
                if (other == plane)
                    append(own.levels(levels), out.nonzeros);
            }
    }
    out.colours.resize(out.blocks.size());
    if (!predicts_anything(out.predictions)) {
        out.forget_copies();
        return;
    }
    for (std::size_t block = 0; block < out.blocks.size(); ++block)
        out.order.push_back(static_cast<std::uint16_t>(block));
}

PlaneTrees::PlaneTrees(const TileCoding& coding, const BitCosts& costs,
                       const EffortSettings& settings) {
    if (!coding.parameters.plane_trees)
        return;
    trees_.reserve(count);
    for (std::size_t plane = 0; plane < count; ++plane) {
        codings_.push_back(&coding.of_plane(static_cast<int>(plane)));
        trees_.emplace_back(*codings_.back(), costs, settings);
    }
}

float PlaneTrees::encode(const TilePlanes& planes, const PictureSearch& pictures, TileLevels& out) {
    take(planes);
    float cost = 0;
    for (std::size_t plane = 0; plane < count; ++plane) {
        trees_[plane].begin_tile(false, true);
        cost += trees_[plane].encode_picture({.shape = planes.shape}, pictures, levels_[plane]);
    }
    join_planes(levels_, out);
    return cost;
}

void PlaneTrees::encode_again(const TilePlanes& planes, const TileLevels& known, TileLevels& out) {
    take(planes);
    take_blocks(known);
    for (std::size_t plane = 0; plane < count; ++plane) {
        plane_.resize(known.shape, 1);
        trees_[plane].encode_again(known_[plane], plane_, nullptr, levels_[plane]);
    }
    join_planes(levels_, out);
    out.splits = known.splits;
}

void PlaneTrees::balance(const TileLevels& known, const Means& error, double gain,
                         TilePlanes& decoded, TileLevels& out) {
    take_blocks(known);
    for (std::size_t plane = 0; plane < count; ++plane) {
        TilePlanes& before = trees_[plane].decoded;
        before.resize(known.shape, 1);
        before.plane[0] = decoded.plane[plane];
        plane_ = before;
        ColourCoding colour;
        colour.desc.type = codings_[plane]->type;
        MeanDebt debt{{error[plane]}, known.shape.texels(), gain, *codings_[plane], colour};
        trees_[plane].encode_again(known_[plane], plane_, &debt, levels_[plane]);
        decoded.plane[plane].swap(plane_.plane[0]);
    }
    join_planes(levels_, out);
    out.splits = known.splits;
}

// Gives each tree its plane as the source.
void PlaneTrees::take(const TilePlanes& planes) {
    for (std::size_t plane = 0; plane < count; ++plane) {
        plane_.resize(planes.shape, 1);
        plane_.plane[0] = planes.plane[plane];
        trees_[plane].search.set_tile(plane_);
    }
}

// Sets known_ to the blocks of each tree, without their levels.
void PlaneTrees::take_blocks(const TileLevels& known) {
    const std::array<std::size_t, count + 1> ends = {0, known.second_tree, known.blocks.size()};
    for (std::size_t plane = 0; plane < count; ++plane) {
        const auto part = [&](const auto& all, auto& own) {
            own.clear();
            if (!all.empty())
                own.assign(all.begin() + static_cast<std::ptrdiff_t>(ends[plane]),
                           all.begin() + static_cast<std::ptrdiff_t>(ends[plane + 1]));
        };
        TileLevels& own = known_[plane];
        own.clear();
        own.shape = known.shape;
        part(known.blocks, own.blocks);
        part(known.colours, own.colours);
        part(known.predictions, own.predictions);
    }
}

} // namespace tessera
