// Overlaps of triangles in the plane.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <map>
#include <unordered_map>
#include <vector>

namespace tessera::corpus {

// The corners of a triangle in the plane.
using FlatTriangle = std::array<glm::dvec2, 3>;

inline double doubled_area(const FlatTriangle& t) {
    const glm::dvec2 p = t[1] - t[0], q = t[2] - t[0];
    return p.x * q.y - p.y * q.x;
}

// Triangles in the plane without overlaps. Each lies in one cell of a grid whose cells are about as
// large as the triangle, so that memory follows the number of triangles, wherever they lie and
// however different their sizes are.
class FlatSheet {
public:
    // Whether the triangle overlaps none of the sheet. Triangles that share an edge do not overlap.
    // A search that takes much longer than usual ends with false: thousands of slivers on one place
    // would otherwise take hours.
    bool is_free(const FlatTriangle& triangle) const;
    // Adds a triangle that is free.
    void put(const FlatTriangle& triangle);
    // Adds the triangle if it is free. Returns whether it was.
    bool add(const FlatTriangle& triangle);

private:
    struct Cell {
        double x, y;
        bool operator==(const Cell&) const = default;
    };
    struct CellHash {
        std::size_t operator()(const Cell& c) const;
    };
    using Grid = std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash>;

    std::map<int, Grid> grids_; // by the exponent of the size of their cells
    std::vector<FlatTriangle> triangles_;
};

} // namespace tessera::corpus
