#include "corpus/surface/lit_surface.h"

#include "corpus/intersect.h"

namespace tessera::corpus {

LitSurface::LitSurface(Scene scene, SurfaceMesh mesh, std::vector<Chart> charts, TexelPlaces places)
    : scene_(std::move(scene)), mesh_(std::move(mesh)), tangents_(mesh_tangents(mesh_)),
      charts_(std::move(charts)), places_(std::move(places)) {}

Result<std::shared_ptr<const LitSurface>>
LitSurface::make(Scene scene, SurfaceMesh mesh, std::vector<Chart> charts, const Texels2& size) {
    TESSERA_TRY_ASSIGN(TexelPlaces places, TexelPlaces::make(mesh, charts, size));
    return std::shared_ptr<const LitSurface>(
        new LitSurface(std::move(scene), std::move(mesh), std::move(charts), std::move(places)));
}

Result<std::shared_ptr<const LitSurface>> LitSurface::finer(std::uint32_t factor) const {
    std::vector<Chart> charts = charts_;
    Texels2 size = places_.size();
    for (std::size_t a = 0; a < 2; ++a) {
        size[a] *= factor;
        for (Chart& chart : charts) {
            chart.begin[a] *= factor;
            chart.extent[a] *= factor;
        }
    }
    return make(scene_, mesh_, std::move(charts), size);
}

const Chart& LitSurface::chart_at(std::uint32_t u, std::uint32_t v) const {
    return charts_[places_.chart_of(places_.place(u, v, {0.0, 0.0}).triangle)];
}

LitSurface::Place LitSurface::at(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const {
    const TrianglePlace place = places_.place(u, v, offset);
    const SurfacePoint point =
        tessera::surface_point(mesh_, tangents_, place.triangle, place.barycentric);
    const Chart& chart = charts_[places_.chart_of(place.triangle)];
    const Object& object = object_of(chart);
    const PartPoint settled =
        settle(object, chart.part, to_local(object, point.position - object.centre));
    return {LitPlace(scene_, object, settled.position, settled.normal), point.frame};
}

} // namespace tessera::corpus
