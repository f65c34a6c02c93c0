// Places beside a triangle as places of the triangles that continue its surface.
#pragma once

#include "corpus/trace/lit_point.h"

#include <array>
#include <vector>

namespace tessera::corpus {

struct Model;

// What lies across each edge where the surface goes on smoothly: the triangle there has the same
// material and nearly the same normals. Texels at the border of a chart show places beside it, and
// light does not end where charts do. Immutable and thread-safe. Memory: 96 bytes per triangle.
class ContinuedSurface {
public:
    explicit ContinuedSurface(const Model& model);

    // The place as it is reached by walking from its triangle over edges, on a surface that is
    // unfolded. Where the surface ends it is still beside the last triangle.
    ModelPlace walk(const ModelPlace& place) const;

private:
    // A triangle across an edge, unfolded into the plane of this one. Places are measured along the
    // edge as a share of it, and above it as a share of the height of the triangle.
    struct Crossing {
        std::int32_t triangle = -1; // nothing
        std::uint32_t side = 0;     // of that triangle, along the edge
        double height = 0;          // of this triangle in heights of that one
        double lean = 0;            // how far the corner of this one lies along the edge
    };

    std::vector<std::array<Crossing, 3>> crossings_; // of the edge from corner k
};

} // namespace tessera::corpus
