#include "tools/view/mesh_renderer.h"

#include "corpus/trace/ray_scene.h"
#include "tools/view/footprint_renderer.h"
#include "tools/view/mip_source.h"

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace tessera {
namespace {

constexpr std::uint64_t most_decoded_mesh_bytes = 1ull << 30; // memory used by decoding

struct MeshPlaces {
    Extent4 size; // of the texture
    MeshSurface surface;
    std::vector<glm::vec3> tangents;
    corpus::RayScene fronts; // rays pass through back faces, as on the GPU
    std::shared_ptr<const AtlasMips> mips;
    std::unique_ptr<TexelSource> with_mips; // null if there are no mips

    Status check(const Camera&) const { return {}; }
    std::optional<SeenTexels> seen(const Camera& camera, const glm::dvec3& direction,
                                   double width) const {
        const auto hit = fronts.first_hit(camera.eye, direction);
        if (!hit)
            return std::nullopt;
        const SurfacePoint point =
            surface_point(surface.mesh, tangents, hit->triangle, hit->barycentric);
        const glm::dvec2 st = octahedral_place(surface.map, point.frame, -direction);
        const double mip = mips->mip_for(
            width * texels_of_pixel(camera, direction, hit->triangle, point.position));
        const auto first = static_cast<unsigned>(mip);
        SeenTexels seen{mips->footprint(surface.map, point.uv, st, first)};
        if (mip > first) {
            seen.second = mips->footprint(surface.map, point.uv, st, first + 1);
            seen.share = mip - first;
        }
        return seen;
    }

    // How many texels of the atlas a pixel covers along u and v.
    glm::dvec2 texels_of_pixel(const Camera& camera, const glm::dvec3& direction,
                               std::uint32_t triangle, const glm::dvec3& place) const {
        const SurfaceMesh& mesh = surface.mesh;
        const auto& [a, b, c] = mesh.triangles[triangle];
        const glm::dvec3 p(mesh.positions[b] - mesh.positions[a]),
            q(mesh.positions[c] - mesh.positions[a]);
        const glm::dvec3 normal = glm::cross(p, q);
        const double square = glm::dot(normal, normal);
        if (square == 0.0)
            return glm::dvec2(0.0);
        glm::dvec2 covered(0.0); // squared
        for (const glm::dvec3& step : camera.steps(direction, place, normal / std::sqrt(square))) {
            const double along_p = glm::dot(glm::cross(step, q), normal) / square;
            const double along_q = glm::dot(glm::cross(p, step), normal) / square;
            const glm::dvec2 uv = glm::dvec2(mesh.uv[b] - mesh.uv[a]) * along_p +
                                  glm::dvec2(mesh.uv[c] - mesh.uv[a]) * along_q;
            covered += uv * uv;
        }
        return glm::sqrt(covered) * glm::dvec2(size[axis_u], size[axis_v]);
    }
};

} // namespace

Result<std::optional<MeshSurface>> mesh_surface(const ContainerReader& container) {
    const Description& d = container.description();
    if (d.proxy != Proxy::mesh)
        return std::optional<MeshSurface>();
    if (d.surface_map != SurfaceMap::mesh_uv ||
        (d.angular_map != AngularMap::octahedral_hemisphere &&
         d.angular_map != AngularMap::octahedral_mirrored))
        return Status(ErrorCode::unsupported,
                      container.name() + ": the texture lies on a mesh, where only the map '" +
                          name_of(SurfaceMap::mesh_uv) + "' with an octahedral map can be drawn");
    TESSERA_TRY_ASSIGN(auto mesh, decode_mesh(container.proxy_mesh(), most_decoded_mesh_bytes)
                                      .with_context(container.name()));
    return std::optional(MeshSurface{std::move(mesh), d.angular_map});
}

Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, const RenderOptions& options) {
    const TileGrid tiles(source.desc().size, block_extent);
    auto mips = std::make_shared<const AtlasMips>(surface.mesh, tiles);
    std::unique_ptr<TexelSource> with_mips;
    if (mips->count() > 0)
        with_mips = make_mip_source(source, *mips, block_extent[axis_v]);
    TexelSource& texels = with_mips ? *with_mips : source;
    TESSERA_TRY_ASSIGN(
        auto fronts, corpus::RayScene::make(surface.mesh.positions, surface.mesh.triangles, true));
    auto tangents = mesh_tangents(surface.mesh);
    MeshPlaces places{source.desc().size, std::move(surface), std::move(tangents),
                      std::move(fronts),  std::move(mips),    std::move(with_mips)};
    return std::unique_ptr<ViewRenderer>(std::make_unique<FootprintRenderer<MeshPlaces>>(
        texels, block_extent, std::move(places), background, options));
}

} // namespace tessera
