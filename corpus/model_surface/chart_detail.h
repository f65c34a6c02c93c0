// How many texels each chart of a model needs.
#pragma once

#include "corpus/model_surface/flat_chart.h"

namespace tessera::corpus {

// Charts shrink at most so much, because shadows need texels, too.
constexpr double least_detail_share = 0.5;

// The texels on a triangle of its material's finest picture; 0 without pictures.
double material_texels(const Model& model, const ModelTriangle& triangle);

// Shrinks charts whose materials have coarse pictures, so that texels go where pictures are fine.
// Returns the density, in texels per world unit, of the charts that keep their size, such that all
// charts together have `texels`, without gutters. Layers are `finer` times finer than the atlas.
double shrink_to_detail(std::vector<FlatChart>& charts, const Model& model, double texels,
                        double finer);

} // namespace tessera::corpus
