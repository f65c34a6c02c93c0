// The surface of a model, cut into flat pieces that are packed into an atlas.
#pragma once

#include "corpus/model_surface/facets.h"
#include "corpus/surface/atlas.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

// The corners of a triangle in the plane, in world units.
using FlatTriangle = std::array<glm::dvec2, 3>;

// Triangles of a model in the plane, counter-clockwise and without overlaps, in the rectangle from
// (0, 0) to `sides`.
struct FlatChart {
    std::vector<std::uint32_t> triangles; // indices into Model::triangles
    std::vector<FlatTriangle> places;     // of each triangle
    glm::dvec2 sides{0.0};
};

// Connected pieces of the model whose normals differ little, projected along their mean normals.
std::vector<FlatChart> cut_by_normal(const Model& model, const Facets& facets);

// The whole model, cut by its normals. Small charts are merged where that saves texels at `density`
// texels per world unit.
std::vector<FlatChart> cut_flat(const Model& model, double density);

// Rotates the chart to the smallest rectangle of a few tries and moves it to (0, 0).
void turn_into_rectangle(FlatChart& chart);

// Packs the charts at `density` texels per world unit. Large charts start at multiples of the tile;
// small ones share a tile. Error: unsupported (too large for an atlas).
Result<Atlas> pack_charts(const std::vector<FlatChart>& charts, double density,
                          const Texels2& tile);

} // namespace tessera::corpus
