// The triangles of a model as a surface: normals, areas and what lies across each edge.
#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

struct Facets {
    std::vector<glm::dvec3> normals; // of unit length
    std::vector<double> areas;
    std::vector<std::array<std::uint32_t, 3>> corners; // those of welded_corners()
    // Across the edge from corner k to corner k + 1; -1: none.
    std::vector<std::array<std::int64_t, 3>> neighbours;
};

// Numbers for the corners of each triangle. Corners at the same position have the same number. Two
// positions are the same if they differ by less than rounding in the transforms of a scene.
std::vector<std::array<std::uint32_t, 3>> welded_corners(const Model& model);

// Where more than two triangles meet at an edge, those with the closest normals are neighbours. Only
// triangles of the same orientation are. Takes about a microsecond per triangle.
Facets facets_of(const Model& model);

} // namespace tessera::corpus
