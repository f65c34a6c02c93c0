// A model's surface cut into pieces that lie flat.
#pragma once

#include "corpus/model/model.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

// Triangles of a model with a place in the plane for each corner, in world units, turned so that
// they stand in the rectangle from (0, 0) to `sides`. None covers another; all are counter-clockwise.
struct FlatChart {
    std::vector<std::uint32_t> triangles;
    std::vector<std::array<glm::dvec2, 3>> places;
    glm::dvec2 sides{0.0};
};

// A triangle that is thinner than all else has its places anyhow.
using FlatTriangle = std::array<glm::dvec2, 3>;

// The corners of each triangle as numbers: the same number for the same position.
std::vector<std::array<std::uint32_t, 3>> welded_corners(const Model& model);

// The islands of the model's own texture coordinates; nothing where these do not lie flat: where
// triangles cover each other, where they are much stretched, or where islands are very many.
std::vector<FlatChart> cut_by_uv(const Model& model);

// Pieces that grow until they bend too much, each seen along its mean normal.
std::vector<FlatChart> cut_by_normal(const Model& model);

// By the model's own coordinates where they do.
std::vector<FlatChart> cut_flat(const Model& model);

// The rectangle with the least area, of a few turns; moves and turns all places into it.
void turn_into_rectangle(FlatChart& chart);

} // namespace tessera::corpus
