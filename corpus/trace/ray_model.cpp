#include "corpus/trace/ray_model.h"

#include "corpus/trace/material_at.h"

#include <algorithm>

namespace tessera::corpus {
namespace {

constexpr int most_walls = 64;                // that a ray passes
constexpr double past = 1e-4;                 // rays go on so far behind a wall
constexpr double least_opacity = 1.0 / 512.0; // of a place that is not invisible

bool is_glass(const ModelMaterial& m) {
    return m.coats && m.coats->through > 0.0;
}

// Places of less alpha are cut out.
double least_alpha(const ModelMaterial& m) {
    return m.blends ? least_opacity : m.cutoff;
}

bool may_be_cut_out(const ModelMaterial& m) {
    return least_alpha(m) > 0.0;
}

bool cut_out(const Model& model, const ModelPlace& place) {
    const ModelMaterial& m = model.materials[model.triangles[place.triangle].material];
    const double least = least_alpha(m);
    return least > 0.0 && alpha_at(model, m, interpolated_at(model, place)) < least;
}

} // namespace

RayModel::RayModel(Model model) : model_(std::move(model)) {}

Result<std::shared_ptr<const RayModel>> RayModel::make(Model model) {
    std::shared_ptr<RayModel> made(new RayModel(std::move(model)));
    std::vector<glm::vec3> positions;
    for (const ModelVertex& v : made->model_.vertices)
        positions.push_back(v.position);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const ModelTriangle& t : made->model_.triangles)
        triangles.push_back(t.vertices);
    RayScene::Passes passes;
    if (std::ranges::any_of(made->model_.materials, may_be_cut_out))
        passes = [&m = made->model_](std::uint32_t triangle, const glm::dvec2& barycentric) {
            return cut_out(m, {triangle, barycentric});
        };
    for (const ModelTriangle& t : made->model_.triangles) {
        const ModelMaterial& m = made->model_.materials[t.material];
        made->has_glass_ |= is_glass(m);
        made->has_blending_ |= m.blends;
    }
    TESSERA_TRY_ASSIGN(made->fronts_,
                       RayScene::make(positions, triangles, true, std::move(passes)));
    TESSERA_TRY_ASSIGN(made->all_, RayScene::make(positions, triangles, false));
    return std::shared_ptr<const RayModel>(std::move(made));
}

std::optional<ModelPlace> RayModel::first_hit(const glm::dvec3& origin,
                                              const glm::dvec3& direction) const {
    const auto hit = fronts_->first_hit(origin, direction);
    if (!hit)
        return std::nullopt;
    return ModelPlace{hit->triangle, hit->barycentric};
}

bool RayModel::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
    return fronts_->is_blocked(origin, direction, reach);
}

template <class SeeThrough>
std::optional<RayHit> RayModel::first_wall(const glm::dvec3& origin, const glm::dvec3& direction,
                                           const SeeThrough& see_through) const {
    glm::dvec3 from = origin;
    auto hit = all_->first_hit(from, direction);
    for (int i = 1; i < most_walls && hit && see_through(material(hit->triangle)); ++i) {
        from += direction * (hit->distance + past);
        hit = all_->first_hit(from, direction);
    }
    return hit;
}

bool RayModel::meets_back(const glm::dvec3& origin, const glm::dvec3& direction) const {
    const auto hit = first_wall(origin, direction, [](const ModelMaterial& m) { return m.blends; });
    return hit && hit->back;
}

bool RayModel::is_walled(const glm::dvec3& origin, const glm::dvec3& direction) const {
    if (!lets_light_pass())
        return all_->is_blocked(origin, direction);
    return first_wall(origin, direction,
                      [](const ModelMaterial& m) { return m.blends || is_glass(m); })
        .has_value();
}

std::optional<RayModel::Side> RayModel::first_side(const glm::dvec3& origin,
                                                   const glm::dvec3& direction) const {
    double before = 0.0;
    for (int i = 0; i < most_walls; ++i) {
        const auto hit = all_->first_hit(origin + direction * before, direction);
        if (!hit)
            return std::nullopt;
        const ModelPlace place{hit->triangle, hit->barycentric};
        const ModelMaterial& m = material(hit->triangle);
        if (hit->back ? is_glass(m) && m.coats->is_volume : !is_cut_out(place))
            return Side{place, before + hit->distance, hit->back};
        before += hit->distance + past;
    }
    return std::nullopt;
}

bool RayModel::is_cut_out(const ModelPlace& place) const {
    return cut_out(model_, place);
}

glm::dvec3 RayModel::emission(const ModelPlace& place) const {
    const ModelMaterial& m = material(place.triangle);
    if (m.emission_texture.image < 0 && !m.is_unlit && !m.blends)
        return m.emission;
    const Interpolated at = interpolated_at(model_, place);
    return opacity_at(model_, m, at) * emission_at(model_, m, at);
}

double RayModel::opacity(const ModelPlace& place) const {
    const ModelMaterial& m = material(place.triangle);
    return m.blends ? opacity_at(model_, m, interpolated_at(model_, place)) : 1.0;
}

LitPoint RayModel::point(const ModelPlace& place) const {
    return lit_point(model_, place);
}

} // namespace tessera::corpus
