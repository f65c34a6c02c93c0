// Tiles of a sample that take most bytes: what trials of a coding tool encode again.
#pragma once

#include "codec/pass/encode_pass.h"

#include <cstddef>

namespace tessera {

class HeavyTiles {
public:
    // `plain`: a pass over the sample with the usual parameters. `plan` outlives this.
    HeavyTiles(const EncodePlan& plan, const Sample& sample, const PassResult& plain,
               std::size_t most);

    // What they cost in that pass, error and bits together, as the encoder weighs them in a tile.
    double plain_cost() const { return plain_cost_; }
    // What they cost with other parameters.
    Result<double> cost(const CodingParameters& parameters) const;
    // Whether any of them can have a base picture.
    bool can_have(const BasePictures& pictures) const;

private:
    const EncodePlan& plan_;
    Sample tiles_;
    double plain_cost_ = 0;
};

} // namespace tessera
