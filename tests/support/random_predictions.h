// Random predictions, which an encoder would hardly write, for tiles with random trees.
#pragma once

#include "codec/tile/tile_levels.h"
#include "codec/tile_encoder/base_picture.h"
#include "codec/tile_encoder/plane_trees.h"
#include "format/tile/prediction.h"
#include "tests/support/random.h"
#include "tests/support/random_tile.h"

#include <algorithm>
#include <span>

namespace tessera::test {

// Copies at most 15 deep in tiles of several views, some of them from the base picture if the tile
// has one, and modes in pictures. Displacements repeat, are small, or are the largest that the
// format allows.
class RandomPredictions {
public:
    // kinds: of transforms. any_plane: see CodingParameters::transforms_any_plane.
    RandomPredictions(Random& random, double chance, const BasePictures& base = {},
                      int kinds = usual_transform_kinds, bool any_plane = false)
        : random_(random), chance_(chance), base_(base), kinds_(kinds), any_plane_(any_plane) {}

    // `base` becomes the tile's base picture and is a tile itself. If it is empty, the tile has
    // none.
    void add_to(TileLevels& tile, TileLevels base = {}) {
        tile.predictions.clear();
        for (const Block& block : tile.blocks)
            tile.predictions.push_back(is_picture(tile.shape) ? mode()
                                       : !base.blocks.empty() && random_.chance(chance_ / 2)
                                           ? prediction_from_base()
                                           : prediction_of(block));
        for (std::size_t i = 0; i < base.blocks.size(); ++i)
            base.predictions.push_back(mode());
        choose_transforms(tile);
        choose_transforms(base);
        // Blocks whose chain of copies is too long stop copying.
        tile.order = limit_copy_depths(tile.shape, tile.blocks, tile.predictions).order;
        if (!base.blocks.empty())
            prepend_base(base, tile);
        else if (!predicts_anything(tile.predictions))
            tile.forget_copies(); // the state that decoders have
    }

private:
    BlockPrediction mode() {
        BlockPrediction prediction;
        if (!random_.chance(chance_))
            return prediction;
        if (random_.chance(0.6))
            last_mode_ = static_cast<BorderMode>(random_.range(1, border_mode_count - 1));
        prediction.mode = last_mode_;
        return prediction;
    }
    // Of blocks that have a symbol for it.
    void choose_transforms(TileLevels& picture) {
        const std::size_t planes =
            picture.blocks.empty() ? 0 : picture.planes.size() / picture.blocks.size();
        for (std::size_t i = 0; i < picture.blocks.size(); ++i) {
            BlockPrediction& prediction = picture.predictions[i];
            const auto has_length = [](const PlaneLevels& plane) { return plane.coded_length > 0; };
            if (std::ranges::any_of(
                    std::span(picture.planes).subspan(i * planes, any_plane_ ? planes : 1),
                    has_length) &&
                transform_context(prediction.mode, picture.blocks[i].shape) >= 0)
                prediction.transform = static_cast<BlockTransform>(random_.range(0, kinds_ - 1));
        }
    }
    BlockPrediction prediction_from_base() {
        if (random_.chance(0.5))
            last_base_ = random_.range(-max_displacement, max_displacement);
        BlockPrediction prediction;
        prediction.from = CopyFrom::base;
        prediction.displacement = base_displacement(base_, last_base_);
        return prediction;
    }
    BlockPrediction prediction_of(const Block& block) {
        const int before = (block.origin[2] > 0 ? 1 : 0) + (block.origin[3] > 0 ? 2 : 0);
        BlockPrediction prediction;
        if (!random_.chance(chance_))
            return prediction;
        prediction.from = static_cast<CopyFrom>(random_.range(0, 2) & before);
        if (prediction.copies())
            prediction.displacement = displacement();
        return prediction;
    }
    Displacement displacement() {
        if (random_.chance(0.3))
            return last_;
        const int most = random_.chance(0.5) ? 5 : max_displacement;
        last_ = {static_cast<std::int8_t>(random_.range(-most, most)),
                 static_cast<std::int8_t>(random_.range(-most, most))};
        if (random_.chance(0.1))
            last_.u = random_.chance(0.5) ? max_displacement : -max_displacement;
        return last_;
    }

    Random& random_;
    const double chance_;
    const BasePictures base_;
    const int kinds_;
    const bool any_plane_;
    int last_base_ = 0;
    BorderMode last_mode_ = mode_mean;
    Displacement last_;
};

// A tile of one view with a tree for each of its two planes.
inline TileLevels random_plane_trees(Random& random, const TileCoding& coding,
                                     const RandomTileOptions& options, const BlockShape& shape,
                                     double chance) {
    std::array<TileLevels, plane_tree_count> planes;
    for (std::size_t plane = 0; plane < planes.size(); ++plane) {
        planes[plane] =
            RandomTile(random, coding.of_plane(static_cast<int>(plane)), options).make(shape);
        RandomPredictions(random, chance, {},
                          coding.parameters.leaves_out_transforms ? transform_kinds
                                                                  : usual_transform_kinds)
            .add_to(planes[plane]);
    }
    TileLevels tile;
    join_planes(planes, tile);
    return tile;
}

// A random tile whose blocks are predicted with probability `chance`. If the file has base pictures, four of
// five tiles have one; if planes may have trees of their own, they do in seven of ten pictures.
inline TileLevels random_predicted_tile(Random& random, const TileCoding& coding,
                                        const RandomTileOptions& options, const BlockShape& shape,
                                        double chance) {
    const BasePictures& pictures = coding.parameters.base;
    if (coding.parameters.plane_trees && is_picture(shape) && random.chance(0.7)) {
        TileLevels tile = random_plane_trees(random, coding, options, shape, chance);
        if (tile.blocks.size() <= max_leaves)
            return tile;
    }
    RandomTile random_tile(random, coding, options);
    TileLevels tile = random_tile.make(shape), base;
    if (const auto picture = base_shape(shape, pictures); picture && random.chance(0.8))
        base = random_tile.make(*picture);
    if (tile.blocks.size() + base.blocks.size() > max_leaves)
        base.clear();
    RandomPredictions(random, chance, pictures,
                      coding.parameters.leaves_out_transforms ? transform_kinds
                                                              : usual_transform_kinds,
                      coding.parameters.transforms_any_plane)
        .add_to(tile, base);
    return tile;
}

} // namespace tessera::test
