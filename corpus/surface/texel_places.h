// The triangle of a mesh that each texel of its atlas shows.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

#include <span>
#include <vector>

namespace tessera::corpus {

// A place on a triangle or, in gutters, beside it in its plane.
struct TrianglePlace {
    std::uint32_t triangle = 0;
    glm::dvec2 barycentric{0.0}; // weights of the second and third corner
};

// Immutable and thread-safe. Memory: 4 bytes per texel.
class TexelPlaces {
public:
    // `mesh` is a decoded mesh. A triangle belongs to the chart that contains its middle. Error:
    // invalid_file, naming a triangle outside all charts.
    static Result<TexelPlaces> make(const SurfaceMesh& mesh, std::span<const Chart> charts,
                                    const Texels2& size);

    const Texels2& size() const { return size_; }
    // Whether the texel is a tap of any place of the mesh.
    bool matters(std::uint32_t u, std::uint32_t v) const { return triangle_at(u, v) != nobody; }
    // The place `offset` texels from the centre of a texel that matters.
    TrianglePlace place(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const;
    std::size_t chart_of(std::uint32_t triangle) const { return chart_of_[triangle]; }

private:
    static constexpr std::uint32_t nobody = UINT32_MAX;

    // Barycentric coordinates as linear functions of the texel.
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
    std::vector<std::uint32_t> triangles_; // of each texel
    std::vector<Slopes> slopes_;           // of each triangle
    std::vector<std::size_t> chart_of_;    // of each triangle
};

} // namespace tessera::corpus
