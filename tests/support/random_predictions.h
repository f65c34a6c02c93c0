// Predictions that an encoder would hardly write, for tiles of random trees.
#pragma once

#include "codec/tile/tile_levels.h"
#include "format/tile/prediction.h"
#include "tests/support/random.h"

#include <algorithm>

namespace tessera::test {

// At most 15 deep. Displacements repeat, are small, or reach as far as the format lets them.
class RandomPredictions {
public:
    RandomPredictions(Random& random, double chance) : random_(random), chance_(chance) {}

    void add_to(TileLevels& tile) {
        tile.predictions.clear();
        for (const Block& block : tile.blocks)
            tile.predictions.push_back(prediction_of(block));
        // Where copies of copies are too deep, the deepest copy nothing.
        tile.order = limit_copy_depths(tile.shape, tile.blocks, tile.predictions).order;
        if (!copies_anything(tile.predictions))
            tile.forget_copies(); // as decoders have it
    }

private:
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
    Displacement last_;
};

} // namespace tessera::test
