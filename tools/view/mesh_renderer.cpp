#include "tools/view/mesh_renderer.h"

#include "corpus/trace/ray_scene.h"
#include "tools/view/footprint_renderer.h"

namespace tessera {
namespace {

constexpr std::uint64_t most_mesh_bytes = 1ull << 30; // of memory, while it is decoded

struct MeshPlaces {
    MeshSurface surface;
    std::vector<glm::vec3> tangents;
    corpus::RayScene fronts; // backs let rays pass, as they do on the GPU

    Status check(const Camera&) const { return {}; }
    std::optional<Footprint> footprint(const Extent4& size, const glm::dvec3& eye,
                                       const glm::dvec3& direction) const {
        const auto hit = fronts.first_hit(eye, direction);
        if (!hit)
            return std::nullopt;
        const SurfacePoint point =
            surface_point(surface.mesh, tangents, hit->triangle, hit->barycentric);
        return mesh_footprint(size, surface.map, point.uv,
                              octahedral_place(surface.map, point.frame, -direction));
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
        return Status(ErrorCode::unsupported, container.name() + ": on a mesh only the map '" +
                                                  name_of(SurfaceMap::mesh_uv) +
                                                  "' with an octahedral one can be drawn");
    TESSERA_TRY_ASSIGN(
        auto mesh,
        decode_mesh(container.proxy_mesh(), most_mesh_bytes).with_context(container.name()));
    return std::optional(MeshSurface{std::move(mesh), d.angular_map});
}

Result<std::unique_ptr<ViewRenderer>>
make_mesh_renderer(TexelSource& source, const Extent4& block_extent, MeshSurface surface,
                   const glm::dvec3& background, const RenderOptions& options) {
    const SurfaceMesh& mesh = surface.mesh;
    TESSERA_TRY_ASSIGN(auto fronts, corpus::RayScene::make(mesh.positions, mesh.triangles, true));
    auto tangents = mesh_tangents(mesh);
    return std::unique_ptr<ViewRenderer>(std::make_unique<FootprintRenderer<MeshPlaces>>(
        source, block_extent,
        MeshPlaces{std::move(surface), std::move(tangents), std::move(fronts)}, background,
        options));
}

} // namespace tessera
