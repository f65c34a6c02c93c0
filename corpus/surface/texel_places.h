// Which triangle of a mesh each texel of its atlas shows.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

#include <span>
#include <vector>

namespace tessera::corpus {

// A triangle, and a place on it or, in gutters, beside it in its plane.
struct TrianglePlace {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
};

// Immutable, hence thread-safe. Memory: 4 bytes a texel.
class TexelPlaces {
public:
    // `mesh` as it was decoded. Triangles belong to the chart that has their middle in the atlas.
    // Errors: invalid_file, naming a triangle that is in none.
    static Result<TexelPlaces> make(const SurfaceMesh& mesh, std::span<const Chart> charts,
                                    const Texels2& size);

    const Texels2& size() const { return size_; }
    // Whether some place of the mesh has the texel as a tap.
    bool matters(std::uint32_t u, std::uint32_t v) const { return triangle_at(u, v) != nobody; }
    // The place that is `offset` texels from the centre of a texel that matters.
    TrianglePlace place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;
    std::size_t chart_of(std::uint32_t triangle) const { return chart_of_[triangle]; }

private:
    static constexpr std::uint32_t nobody = UINT32_MAX;

    // Barycentric coordinates of the atlas' texels: linear in them.
    struct Slopes {
        glm::dvec2 corner, along_u, along_v;
    };

    TexelPlaces() = default;
    void cover(const SurfaceMesh& mesh);
    void grow(const Chart& chart);
    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    std::uint32_t triangle_at(std::uint32_t u, std::uint32_t v) const {
        return triangles_[index(u, v)];
    }
    glm::dvec2 barycentric(std::uint32_t triangle, const glm::dvec2& texel) const;
    double outside(std::uint32_t triangle, const glm::dvec2& texel) const;

    Texels2 size_{0, 0};
    std::vector<std::uint32_t> triangles_; // a texel
    std::vector<Slopes> slopes_;           // a triangle
    std::vector<std::size_t> chart_of_;    // a triangle
};

} // namespace tessera::corpus
