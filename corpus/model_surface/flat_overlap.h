// Overlaps of triangles in the plane.
#pragma once

#include "corpus/model_surface/flat_chart.h"

#include <unordered_map>

namespace tessera::corpus {

inline double doubled_area(const FlatTriangle& t) {
    const glm::dvec2 p = t[1] - t[0], q = t[2] - t[0];
    return p.x * q.y - p.y * q.x;
}

// Triangles in the plane without overlaps, sorted into cells.
class FlatSheet {
public:
    explicit FlatSheet(double cell) : cell_(cell) {}
    // Adds the triangle unless it overlaps one of the sheet; returns whether it was added.
    // Triangles that share an edge do not overlap.
    bool add(const FlatTriangle& triangle);

private:
    template <class Visit> void cells_of(const FlatTriangle& triangle, const Visit& visit) const;

    double cell_;
    std::vector<FlatTriangle> triangles_;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

} // namespace tessera::corpus
