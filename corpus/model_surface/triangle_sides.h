// Sides and places of the triangles of a model.
#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// The place with these weights of the second and third corner.
inline glm::dvec3 place_on(const Model& model, const ModelTriangle& triangle,
                           const glm::dvec2& weights) {
    const auto& [a, b, c] = triangle.vertices;
    const glm::dvec3 p(model.vertices[a].position);
    return p + weights.x * (glm::dvec3(model.vertices[b].position) - p) +
           weights.y * (glm::dvec3(model.vertices[c].position) - p);
}

// That from corner k to corner k + 1.
inline double side_length(const Model& model, const ModelTriangle& triangle, std::size_t k) {
    return glm::length(glm::dvec3(model.vertices[triangle.vertices[(k + 1) % 3]].position) -
                       glm::dvec3(model.vertices[triangle.vertices[k]].position));
}

inline std::size_t longest_side(const Model& model, const ModelTriangle& triangle) {
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
        if (side_length(model, triangle, k) > side_length(model, triangle, longest))
            longest = k;
    return longest;
}

} // namespace tessera::corpus
