// The surface that a texture lies on: triangles with a place of the atlas at every corner, and what
// their coordinates mean (FORMAT.md 5.2). The baker, the CPU sampler and the shaders agree
// on this file.
#pragma once

#include "format/levels.h"
#include "format/metadata.h"
#include "format/sampler.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace TESSERA_PUBLIC tessera {

// Vertices belong to one chart: where two charts meet they stand twice. World units.
struct SurfaceMesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals; // of unit length, one a vertex; away from the inside
    std::vector<glm::vec2> uv; // 0..1 over the atlas, one a vertex; texel i of N at (i + 0.5) / N
    std::vector<std::array<std::uint32_t, 3>> triangles; // counter-clockwise seen from outside
};

// How finely a stream holds the numbers: bits of a coordinate over the longest side of the mesh's
// box, of uv over 0..1 (both 4..24), and of each of a normal's two octahedral coordinates (3..16).
// 0 bits of normals: the stream has none, and readers compute them (FORMAT.md 5.2), smooth where
// triangles meet at less than 45 degrees. That saves a sixth of a closed surface's bytes.
struct MeshQuantisation {
    unsigned position_bits = 12, uv_bits = 12, normal_bits = 0;
};

// Section `prxy`: a Draco stream. What decodes has the same triangles, but for those with two corners
// at one place, and may have other vertices in another order: only the decoded mesh is what viewers
// see, and bakers must start from it. `mesh.normals` may be empty where none are stored. The bytes
// depend on the arguments only. Time: some 10 microseconds a triangle. Errors: bad_argument, naming
// the first element that is wrong (index out of range, a number that is not finite, uv outside 0..1),
// or where no triangle is left; runtime (out of memory, the bytes do not decode to the same count).
Result<std::vector<std::byte>> encode_mesh(const SurfaceMesh& mesh, const MeshQuantisation& bits);

// Checked like all else from outside. Errors: invalid_file; unsupported where it could take more
// than `most_bytes` of memory, for which a stream claims 1,000 bytes a triangle and 16 MiB; runtime
// (out of memory).
Result<SurfaceMesh> decode_mesh(std::span<const std::byte> stream, std::uint64_t most_bytes);

// Of each vertex, of unit length and at right angles to its normal: the way in which u grows over
// the triangles around it, weighted by their areas; where that is undefined, the axis that leans
// least to the normal, made so.
std::vector<glm::vec3> mesh_tangents(const SurfaceMesh& mesh);

// A place on the mesh: normal and tangent interpolated, made of unit length and at right angles.
// With normals that cancel out, those of the first corner.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    SurfaceFrame frame{}; // ex along the tangent, ez the normal, ey = ez x ex
    glm::dvec2 uv{0.0};
};

// `barycentric`: weights of the triangle's second and third corner.
SurfacePoint surface_point(const SurfaceMesh& mesh, std::span<const glm::vec3> tangents,
                           std::uint32_t triangle, const glm::dvec2& barycentric);

// (s, t) in 0..1 of the unit direction `d`, away from the surface, in one of the octahedral maps of
// a mesh; and back: the unit direction that leaves at (s, t). A direction into the surface
// (d . ez < 0) is taken for the nearest one along it, one against the normal for the normal. With the
// mirrored map some (s, t) stand for directions into the surface: nobody sees them.
glm::dvec2 octahedral_place(AngularMap map, const SurfaceFrame& frame, const glm::dvec3& d);
glm::dvec3 octahedral_direction(AngularMap map, const SurfaceFrame& frame, double s, double t);

// The texels seen at the place `uv` of the atlas and (s, t) of the angular image: linear along all
// four axes; (u, v) end at the atlas' edges, (s, t) go on as the map folds. No extent of `size` is 0.
Footprint mesh_footprint(const Extent4& size, AngularMap map, const glm::dvec2& uv,
                         const glm::dvec2& st);

// Calls visit(u, v) for the texels of `size` whose squares have a place in common with a triangle of the
// atlas, its corners in texels; none where it has no area.
void visit_covered_texels(const std::array<glm::dvec2, 3>& corners,
                          const std::array<std::uint32_t, 2>& size,
                          const std::function<void(std::uint32_t u, std::uint32_t v)>& visit);

// Mip levels of an atlas, which readers make of its texels (FORMAT.md 5.2): which there are, which chart
// each of their texels shows, and where they are kept beside the atlas, mip 0. Immutable.
class AtlasMips {
public:
    static constexpr unsigned most = 4; // besides the atlas

    AtlasMips() = default; // the atlas alone, of no texels
    // Of a texture that `grid` cuts into tiles. None where tiles cannot be halved, of atlases of more
    // than 2^26 texels, and where triangles cover them many times. Memory: 6 bytes a texel of U x V.
    AtlasMips(const SurfaceMesh& mesh, const TileGrid& grid);

    unsigned count() const { return static_cast<unsigned>(levels_.size()) - 1; }
    std::array<std::uint32_t, 2> size(unsigned mip) const { return levels_[mip].size; }
    // Of each texel, u fastest: 1 + the number of its chart's first triangle; 0: it shows none. Empty where
    // there are no mips.
    std::span<const std::uint32_t> charts(unsigned mip) const { return levels_[mip].charts; }

    // A texture that has the mips, too: as wide as three halves of the atlas, in whole tiles. Mip 1 and
    // above lie beside the atlas at begin(). Of any mesh on such a texture the same.
    static Extent4 kept_size(const TileGrid& grid);
    Extent4 kept_size() const { return kept_; }
    std::array<std::uint32_t, 2> begin(unsigned mip) const { return levels_[mip].begin; }

    // Which mip suits a ray that stands for this many texels of the atlas along u and v: between two,
    // the samples of both are mixed linearly.
    double mip_for(const glm::dvec2& texels) const;
    // mesh_footprint() in one mip of the texture of kept_size(). Of the texels around the place those
    // count that show its chart; where none does, the atlas' own.
    Footprint footprint(AngularMap map, const glm::dvec2& uv, const glm::dvec2& st,
                        unsigned mip) const;

private:
    struct Level {
        std::array<std::uint32_t, 2> size{0, 0}, begin{0, 0};
        std::vector<std::uint32_t> charts;
    };
    std::uint32_t chart(unsigned mip, std::uint32_t x, std::uint32_t y) const {
        const Level& level = levels_[mip];
        return level.charts[std::size_t{y} * level.size[0] + x];
    }
    void find_charts(const SurfaceMesh& mesh);
    void halve(unsigned mip);

    Extent4 size_{0, 0, 0, 0}, kept_{0, 0, 0, 0};
    std::vector<Level> levels_{1};
};

} // namespace tessera
