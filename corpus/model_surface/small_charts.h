// Where the charts of a model lie in the atlas.
#pragma once

#include "corpus/model_surface/flat_chart.h"
#include "corpus/surface/atlas.h"

namespace tessera::corpus {

// Large ones start at multiples of the tile; small ones share tiles, but lie in one each. Errors:
// unsupported, too large for an atlas.
Result<Atlas> pack_charts(const std::vector<FlatChart>& charts, double density,
                          const Texels2& tile);

} // namespace tessera::corpus
