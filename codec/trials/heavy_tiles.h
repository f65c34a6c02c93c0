// Tiles of a sample that take most bytes: what trials of a coding tool encode again.
#pragma once

#include "codec/pass/encode_pass.h"

#include <cstddef>

namespace tessera {

class HeavyTiles {
public:
    // `known`: a pass over the sample. `plan` outlives this.
    HeavyTiles(const EncodePlan& plan, const Sample& sample, const PassResult& known,
               std::size_t most);

    // What they cost in that pass, error and bits together, as the encoder weighs them in a tile.
    double known_cost() const { return known_cost_; }
    // What they cost with other parameters.
    Result<double> cost(const CodingParameters& parameters) const;

private:
    const EncodePlan& plan_;
    Sample tiles_;
    double known_cost_ = 0;
};

} // namespace tessera
