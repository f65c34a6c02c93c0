// The surface of a model, cut into flat pieces that are packed into an atlas.
#pragma once

#include "corpus/model_surface/facets.h"
#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

#include <glm/vec2.hpp>
#include <span>

namespace tessera::corpus {

// Triangles of a model in the plane, counter-clockwise and without overlaps, in the rectangle from
// (0, 0) to `sides`: their projection along the axes of `shape`.
struct FlatChart {
    std::vector<std::uint32_t> triangles; // indices into Model::triangles
    glm::dvec2 sides{0.0};                // with the scale of `shape`
    MeshChart shape;                      // without its begin
    double share = 1.0; // of the density of the finest charts, as its places are viewed
};

// The whole model as connected pieces whose normals differ little, projected along their mean
// normals and turned into small rectangles. `shares` are those of viewed_shares(), or empty: the
// triangles of a chart need about the same density.
std::vector<FlatChart> cut_flat(const Model& model, std::span<const double> shares = {});

// Sets FlatChart::sides to those of other positions of the triangles.
void measure_sides(FlatChart& chart, const Model& model);

// A density, at most `density`, at which gutters do not take much more than half of `texels`: loose
// triangles have a chart each.
double density_with_gutters(const std::vector<FlatChart>& charts, double density, double texels);

// Packs the charts at `density` texels per world unit. Large charts start at multiples of the tile;
// small ones share a tile. The sides of the atlas are multiples of `side_step`. Error: unsupported
// (too large for an atlas).
Result<Atlas> pack_charts(const std::vector<FlatChart>& charts, double density, const Texels2& tile,
                          std::uint32_t side_step = 1);

} // namespace tessera::corpus
