// Fewer charts: small ones join the chart beside them.
#pragma once

#include "corpus/model_surface/flat_chart.h"

namespace tessera::corpus {

// Joins charts across edges that are smooth, without changing their shapes, where that saves texels
// at `density` texels per world unit. The charts hold each triangle once. Takes a few microseconds
// per triangle.
std::vector<FlatChart> merge_charts(std::vector<FlatChart> charts, const Facets& facets,
                                    double density);

} // namespace tessera::corpus
