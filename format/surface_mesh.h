// The surface that a texture lies on: triangles with a position in the atlas at every corner, and
// what the coordinates of the texture mean on it (FORMAT.md 5.2). The baker, the CPU sampler and
// the shaders must agree on this file. All functions are thread-safe.
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

// A vertex belongs to one chart: where two charts meet, two vertices have the same position.
struct SurfaceMesh {
    std::vector<glm::vec3> positions; // world units
    std::vector<glm::vec3> normals;   // unit length, one per vertex, pointing out of the object
    // 0..1 over the atlas, one per vertex. The centre of texel i of N is at (i + 0.5) / N.
    std::vector<glm::vec2> uv;
    std::vector<std::array<std::uint32_t, 3>> triangles; // counter-clockwise seen from outside
};

// The least box with edges along the axes around all positions, of which there is at least one.
struct MeshBounds {
    glm::dvec3 low{0.0}, high{0.0};
    glm::dvec3 centre() const { return 0.5 * (low + high); }
    double diagonal() const;
};
MeshBounds bounds_of(const SurfaceMesh& mesh);

// The precision of an encoded mesh. Without stored normals, readers compute them (FORMAT.md 5.2),
// smooth across edges where triangles meet at less than 45 degrees; a closed surface then takes a
// sixth fewer bytes.
struct MeshQuantisation {
    unsigned position_bits = 12; // 4..24, per coordinate, over the longest side of the bounding box
    unsigned uv_bits = 12;       // 4..24, per coordinate, over 0..1
    unsigned normal_bits = 0;    // 3..16, per octahedral coordinate; 0: no normals are stored
};

// Encodes a mesh with any uv as a Draco stream, one of the contents of section `prxy`. `mesh.normals` may be empty if
// none are stored. The decoded mesh has the same triangles, except those with two corners at the
// same position, but may have other vertices in another order. Viewers see only the decoded mesh,
// so bakers must start from it. The bytes depend only on the arguments. Takes about 10 microseconds
// per triangle. Errors: bad_argument, which names the first wrong element (index out of range, a
// number that is not finite, uv outside 0..1) or says that no triangle is left; runtime (out of
// memory, or the bytes decode to another number of triangles).
Result<std::vector<std::byte>> encode_mesh(const SurfaceMesh& mesh, const MeshQuantisation& bits);

// A flat piece of a surface: the uv of its corners are their positions, projected. That takes half
// the bytes of a mesh with any uv.
struct MeshChart {
    // Turns the world so that u and v grow along x and y: a quaternion (x, y, z, w) of any length
    // above 0.
    std::array<std::int8_t, 4> rotation{0, 0, 0, 1};
    std::uint8_t scale = 255; // (scale + 1) / 256 of MeshCharts::density
    // The least u and v of the chart, in texels of the atlas.
    std::array<std::uint32_t, 2> begin{0, 0};
};

struct MeshCharts {
    std::array<std::uint32_t, 2> size{1, 1}; // of the atlas, in texels
    float density = 1;                       // texels per world unit
    std::vector<MeshChart> charts;
    std::vector<std::uint32_t> chart_of; // per triangle
};

// The directions in the world in which u and v of a chart grow, of unit length.
std::array<glm::dvec3, 2> chart_axes(const MeshChart& chart);

// A mesh with charts is encoded in three steps, because charts are laid out on the mesh that viewers
// see: encode_shape() encodes everything but uv, decode_shape() gives the decoded mesh without uv,
// and add_charts() makes the content of section `prxy` of the shape and charts for the triangles of
// that mesh. Errors: those of encode_mesh() and decode_mesh(); bad_argument if a chart is wrong.
Result<std::vector<std::byte>> encode_shape(const SurfaceMesh& mesh, const MeshQuantisation& bits);
Result<SurfaceMesh> decode_shape(std::span<const std::byte> shape, std::uint64_t most_bytes);
Result<std::vector<std::byte>> add_charts(std::span<const std::byte> shape,
                                          const MeshCharts& charts);

// Decodes section `prxy`, which may be damaged or malicious. Computes normals if none are stored.
// Errors: invalid_file; unsupported if it could take more than `most_bytes` of memory, counting
// 1,000 bytes per triangle and 16 MiB; runtime (out of memory). `charts`, if not null, gets the
// charts that give the uv, for the triangles of the result; none if the section stores uv.
Result<SurfaceMesh> decode_mesh(std::span<const std::byte> stream, std::uint64_t most_bytes,
                                MeshCharts* charts = nullptr);

// A tangent per vertex, of unit length and perpendicular to the vertex's normal: the direction in
// which u grows, averaged over the triangles around the vertex by their areas. Where that is
// undefined, it is the coordinate axis that is closest to perpendicular to the normal, made
// perpendicular.
std::vector<glm::vec3> mesh_tangents(const SurfaceMesh& mesh);

// A point on the mesh. The normal and the tangent of its frame are interpolated and made
// orthonormal. If the interpolated normals cancel out, the normal is that of the first corner.
struct SurfacePoint {
    glm::dvec3 position{0.0};
    SurfaceFrame frame{}; // ex along the tangent, ez the normal, ey = ez x ex
    glm::dvec2 uv{0.0};
};

// The point of a triangle with these barycentric weights of its second and third corner. `tangents`
// are those of mesh_tangents().
SurfacePoint surface_point(const SurfaceMesh& mesh, std::span<const glm::vec3> tangents,
                           std::uint32_t triangle, const glm::dvec2& barycentric);

// (s, t) in 0..1 of the unit direction `d`, which points away from the surface, in an octahedral
// map. A direction into the surface (d . ez < 0) is replaced by the nearest one along the surface,
// and -ez by ez. octahedral_direction() is the inverse: the unit direction that leaves the surface
// at (s, t). In the mirrored map, some (s, t) stand for directions into the surface, which no
// observer sees.
glm::dvec2 octahedral_place(AngularMap map, const SurfaceFrame& frame, const glm::dvec3& d);
glm::dvec3 octahedral_direction(AngularMap map, const SurfaceFrame& frame, double s, double t);

// The texels seen at `uv` of the atlas and `st` of the angular image, interpolated linearly along
// all four axes. (u, v) are clamped at the edges of the atlas; beyond the edges of the angular
// image, (s, t) continue as the map folds. Precondition: no extent of `size` is 0.
Footprint mesh_footprint(const Extent4& size, AngularMap map, const glm::dvec2& uv,
                         const glm::dvec2& st);

// Calls visit(u, v) for each texel of an atlas of `size` whose square intersects the triangle with
// these corners, which are in texels. A triangle without area covers none.
void visit_covered_texels(const std::array<glm::dvec2, 3>& corners,
                          const std::array<std::uint32_t, 2>& size,
                          const std::function<void(std::uint32_t u, std::uint32_t v)>& visit);

// The mip levels of an atlas, which readers compute from its texels (FORMAT.md 5.2): how many there
// are, which chart each of their texels shows, and where they are stored beside the atlas. The
// atlas is mip 0. Immutable.
class AtlasMips {
public:
    static constexpr unsigned most = 4; // the largest count()

    AtlasMips() = default; // for an atlas without texels: there are no mips
    // For a texture that `grid` cuts into tiles. There are no mips if the tiles do not begin at
    // even texels, if the atlas has more than 2^26 texels, or if the triangles cover it many times.
    // Takes 6 bytes of memory per texel of the atlas.
    AtlasMips(const SurfaceMesh& mesh, const TileGrid& grid);

    // The count() of those mips, without making them, and the side of a mip of an atlas with this side.
    static unsigned count_of(const SurfaceMesh& mesh, const TileGrid& grid);
    static std::uint32_t side_of(std::uint32_t side, unsigned mip) {
        return ((side - 1) >> mip) + 1;
    }

    // The number of mips besides the atlas.
    unsigned count() const { return static_cast<unsigned>(levels_.size()) - 1; }
    std::array<std::uint32_t, 2> size(unsigned mip) const { return levels_[mip].size; }
    // Per texel, u fastest: 1 + the index of the first triangle of the chart that it shows, or 0 if
    // it shows none. Empty if there are no mips.
    std::span<const std::uint32_t> charts(unsigned mip) const { return levels_[mip].charts; }

    // The size of a texture that holds the atlas and, beside it, mip 1 and above at begin(): one
    // and a half times as wide as the atlas, rounded up to whole tiles. It does not depend on the
    // mesh.
    static Extent4 kept_size(const TileGrid& grid);
    // The same, but the size of the texture itself if there are no mips.
    Extent4 kept_size() const { return kept_; }
    std::array<std::uint32_t, 2> begin(unsigned mip) const { return levels_[mip].begin; }

    // The mip for a pixel that covers this many texels of the atlas along u and along v. Between
    // two whole numbers, the samples of both mips are mixed linearly.
    double mip_for(const glm::dvec2& texels) const;
    // mesh_footprint() in one mip, in a texture of kept_size(). Only texels that show the chart at
    // `uv` count. If none of them does, it is the footprint in the atlas.
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
