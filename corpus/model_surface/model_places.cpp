#include "corpus/model_surface/model_places.h"

#include "corpus/trace/path_random.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

namespace tessera::corpus {
namespace {

constexpr unsigned hidden_rays = 24;
constexpr double least_alike = 0.9; // cosine between the normals of a texel's places

// The nearest place within the triangle, a little off its edges: rays that start on an edge slip
// through the surface that meets it there.
glm::dvec2 inside(const Model& model, const ModelPlace& place) {
    constexpr double least = 5e-4, most_share = 0.15;
    std::array<glm::dvec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        corners[k] = model.vertices[model.triangles[place.triangle].vertices[k]].position;
    const double area = glm::length(area_vector(model, model.triangles[place.triangle]));
    glm::dvec3 w{1.0 - place.barycentric.x - place.barycentric.y, place.barycentric};
    for (glm::length_t k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double edge = glm::length(corners[(i + 1) % 3] - corners[(i + 2) % 3]);
        w[k] = std::max(w[k], area > 0.0 ? std::min(least * edge / area, most_share) : 0.0);
    }
    const double sum = w.x + w.y + w.z;
    return {w.y / sum, w.z / sum};
}

// The vector, turned as `from` is turned to `to`. Both are unit vectors that face alike.
glm::dvec3 turned(const glm::dvec3& v, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 middle = from + to;
    return v - middle * (glm::dot(v, middle) / (1.0 + glm::dot(from, to))) +
           2.0 * glm::dot(v, from) * to;
}

// How far a place is outside the triangle; at most 0 within it.
double outside(const glm::dvec2& b) {
    return -std::min({b.x, b.y, 1.0 - b.x - b.y});
}

} // namespace

ModelPlaces::ModelPlaces(std::shared_ptr<const SurfaceMesh> mesh, std::vector<Chart> charts,
                         std::shared_ptr<const RayModel> model,
                         std::shared_ptr<const ContinuedSurface> continued, TexelPlaces places)
    : mesh_(std::move(mesh)), tangents_(mesh_tangents(*mesh_)), charts_(std::move(charts)),
      model_(std::move(model)), continued_(std::move(continued)), places_(std::move(places)) {}

Result<ModelPlaces> ModelPlaces::make(ModelAtlas atlas) {
    TESSERA_TRY_ASSIGN(TexelPlaces places, TexelPlaces::make(atlas.mesh, atlas.charts, atlas.size));
    TESSERA_TRY_ASSIGN(auto model, RayModel::make(std::move(atlas.model)));
    auto continued = std::make_shared<const ContinuedSurface>(model->model());
    return ModelPlaces(std::make_shared<const SurfaceMesh>(std::move(atlas.mesh)),
                       std::move(atlas.charts), std::move(model), std::move(continued),
                       std::move(places));
}

Result<ModelPlaces> ModelPlaces::finer(std::uint32_t times) const {
    std::vector<Chart> charts = charts_;
    for (Chart& chart : charts)
        for (std::size_t a = 0; a < 2; ++a) {
            chart.begin[a] *= times;
            chart.extent[a] *= times;
        }
    const Texels2 size{places_.size()[0] * times, places_.size()[1] * times};
    TESSERA_TRY_ASSIGN(TexelPlaces places, TexelPlaces::make(*mesh_, charts, size));
    return ModelPlaces(mesh_, std::move(charts), model_, continued_, std::move(places));
}

// The place on the nearest triangle around the texel, because triangles may be as small as texels.
ModelSurfacePlace ModelPlaces::place(std::uint32_t u, std::uint32_t v,
                                     const glm::dvec2& offset) const {
    TrianglePlace best = places_.place(u, v, offset);
    const std::size_t chart = places_.chart_of(best.triangle);
    double least = outside(best.barycentric);
    for (int y = -1; y <= 1 && least > 0.0; ++y)
        for (int x = -1; x <= 1; ++x) {
            const std::int64_t nu = std::int64_t{u} + x, nv = std::int64_t{v} + y;
            if (nu < 0 || nv < 0 || nu >= places_.size()[0] || nv >= places_.size()[1])
                continue;
            const auto cu = static_cast<std::uint32_t>(nu), cv = static_cast<std::uint32_t>(nv);
            if (!places_.matters(cu, cv))
                continue;
            const TrianglePlace other = places_.place(cu, cv, offset - glm::dvec2(x, y));
            if (places_.chart_of(other.triangle) == chart && outside(other.barycentric) < least) {
                least = outside(other.barycentric);
                best = other;
            }
        }
    const ModelPlace beside{best.triangle, best.barycentric};
    const ModelPlace own{best.triangle, inside(model_->model(), beside)};
    const SurfaceFrame frame = frame_at(own);
    if (least > 0.0)
        if (const ModelPlace to = continued_->walk(beside); to.triangle != own.triangle) {
            const ModelPlace on{to.triangle, inside(model_->model(), to)};
            const glm::dvec3 normal = frame_at(on).ez;
            if (glm::dot(normal, frame.ez) > least_alike) {
                LitPoint point = model_->point(on);
                point.normal = turned(point.normal, normal, frame.ez);
                return {point, frame, on, chart};
            }
        }
    return {model_->point(own), frame, own, chart};
}

SurfaceFrame ModelPlaces::frame_at(const ModelPlace& on) const {
    return surface_point(*mesh_, tangents_, on.triangle, on.barycentric).frame;
}

std::optional<Texels2> ModelPlaces::texel_beside(std::uint32_t u, std::uint32_t v,
                                                 const glm::dvec2& offset) const {
    const TrianglePlace from = places_.place(u, v, offset);
    const ModelPlace to = continued_->walk({from.triangle, from.barycentric});
    if (to.triangle == from.triangle || !(outside(to.barycentric) <= 0.0))
        return std::nullopt;
    const auto& [a, b, c] = mesh_->triangles[to.triangle];
    const glm::dvec2 uv = glm::dvec2(mesh_->uv[a]) * (1.0 - to.barycentric.x - to.barycentric.y) +
                          glm::dvec2(mesh_->uv[b]) * to.barycentric.x +
                          glm::dvec2(mesh_->uv[c]) * to.barycentric.y;
    Texels2 texel;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double last = places_.size()[axis] - 1.0;
        texel[axis] = static_cast<std::uint32_t>(std::clamp(
            std::floor(uv[static_cast<glm::length_t>(axis)] * places_.size()[axis]), 0.0, last));
    }
    return texel;
}

bool ModelPlaces::is_inside(std::uint32_t u, std::uint32_t v, const glm::dvec2& offset) const {
    const LitPoint p = place(u, v, offset).point;
    for (unsigned i = 0; i < hidden_rays; ++i) {
        PathRandom random(0, i);
        const glm::dvec3 d = sample_cosine(p.face, random.next2());
        if (!model_->meets_back(p.position + 1e-3 * p.face, d))
            return false;
    }
    return true;
}

bool ModelPlaces::is_hidden(std::uint32_t u, std::uint32_t v) const {
    for (const glm::dvec2 offset : {glm::dvec2(0, 0), glm::dvec2(-1, -1), glm::dvec2(1, -1),
                                    glm::dvec2(-1, 1), glm::dvec2(1, 1)})
        if (!is_inside(u, v, offset))
            return false;
    return true;
}

} // namespace tessera::corpus
