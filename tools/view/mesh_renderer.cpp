#include "tools/view/mesh_renderer.h"

#include "tools/view/footprint_renderer.h"
#include "tools/view/mesh_rays.h"
#include "tools/view/mip_source.h"

#include <glm/geometric.hpp>

namespace tessera {
namespace {

constexpr std::uint64_t most_decoded_mesh_bytes = 1ull << 30; // memory used by decoding

struct MeshPlaces {
    Extent4 size; // of the texture
    AngularMap map;
    MeshRays rays;
    std::shared_ptr<const AtlasMips> mips;
    std::unique_ptr<TexelSource> with_mips; // null if there are no mips

    Status check(const Camera&) const { return {}; }
    std::optional<SeenTexels> seen(const Camera& camera, const glm::dvec3& direction,
                                   double width) const {
        const auto hit = rays.first_hit(camera, direction);
        if (!hit)
            return std::nullopt;
        return seen_from(hit->point, -direction, width * hit->covered);
    }
    SeenTexels seen_from(const SurfacePoint& point, const glm::dvec3& view,
                         const glm::dvec2& covered) const {
        const glm::dvec2 st = octahedral_place(map, point.frame, view);
        return texels_in_mips(*mips, size, map, point.uv, st, covered);
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
    MeshSurface surface{.mesh = {}, .map = d.angular_map};
    TESSERA_TRY_ASSIGN(surface.mesh,
                       decode_mesh(container.proxy_mesh(), most_decoded_mesh_bytes, &surface.charts)
                           .with_context(container.name()));
    return std::optional(std::move(surface));
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
    const AngularMap map = surface.map;
    TESSERA_TRY_ASSIGN(MeshRays rays, MeshRays::make(std::move(surface.mesh)));
    MeshPlaces places{source.desc().size, map, std::move(rays), std::move(mips),
                      std::move(with_mips)};
    return std::unique_ptr<ViewRenderer>(std::make_unique<FootprintRenderer<MeshPlaces>>(
        texels, block_extent, std::move(places), background, options));
}

} // namespace tessera
