#include "corpus/trace/emitters.h"

#include "corpus/trace/sampled_sums.h"

#include <algorithm>
#include <cmath>

namespace tessera::corpus {
namespace {

// Emission textures are often black except for a few places, so the power of a triangle comes from
// its own part of the texture and of that of alpha. Small bright places can lie between the trials. Hence this share of
// the mean of the whole texture is added.
constexpr unsigned textured_trials = 32;
constexpr double texture_share = 0.05;

double mean_channel(const glm::dvec3& x) {
    return (x.x + x.y + x.z) / 3.0;
}

// Maps the unit square to the triangle. Keeps areas.
glm::dvec2 folded(const glm::dvec2& random) {
    return random.x + random.y > 1.0 ? 1.0 - random : random;
}

glm::dvec3 corner(const Model& model, std::uint32_t triangle, std::size_t k) {
    return glm::dvec3(model.vertices[model.triangles[triangle].vertices[k]].position);
}

double mean_of_texture(const Model& model, const ModelMaterial& m) {
    const Image& image = model.images[static_cast<std::size_t>(m.emission_texture.image)];
    glm::dvec3 sum(0.0);
    std::array<double, 256> linear{};
    for (std::size_t i = 0; i < 256; ++i)
        linear[i] = srgb_to_linear(static_cast<double>(i) / 255.0);
    for (const auto& texel : image.texels)
        sum += glm::dvec3(linear[texel[0]], linear[texel[1]], linear[texel[2]]);
    return mean_channel(m.emission * sum) /
           static_cast<double>(std::max<std::size_t>(image.texels.size(), 1));
}

// For each material the light that is added to that of its triangles.
std::vector<double> floors_of(const Model& model) {
    std::vector<double> floors;
    for (const ModelMaterial& m : model.materials)
        floors.push_back(is_lamp(m) && m.emission_texture.image >= 0
                             ? texture_share * mean_of_texture(model, m)
                             : 0.0);
    return floors;
}

// The mean light of the triangle.
double mean_light(const RayModel& rays, std::uint32_t triangle) {
    const ModelMaterial& m = rays.model().materials[rays.model().triangles[triangle].material];
    if (m.emission_texture.image < 0 && !m.blends)
        return mean_channel(m.emission);
    double sum = 0;
    for (unsigned i = 0; i < textured_trials; ++i) {
        // The R2 sequence (Roberts 2018) covers the square evenly.
        const glm::dvec2 place = glm::fract(
            glm::dvec2(0.5) + (i + 1.0) * glm::dvec2(0.7548776662466927, 0.5698402909980532));
        sum += mean_channel(rays.emission({triangle, folded(place)}));
    }
    return sum / textured_trials;
}

} // namespace

Emitters::Emitters(std::shared_ptr<const RayModel> model) : model_(std::move(model)) {
    const Model& m = model_->model();
    if (std::ranges::none_of(m.materials, is_lamp))
        return;
    const std::vector<double> floors = floors_of(m);
    per_area_.assign(m.triangles.size(), 0.0);
    double sum = 0;
    for (std::uint32_t i = 0; i < m.triangles.size(); ++i) {
        const std::uint32_t material = m.triangles[i].material;
        if (!is_lamp(m.materials[material]))
            continue;
        const double area = 0.5 * glm::length(area_vector(m, m.triangles[i]));
        const double light = mean_light(*model_, i) + floors[material];
        if (!(area * light > 0.0))
            continue;
        sum += area * light;
        per_area_[i] = light;
        triangles_.push_back(i);
        powers_.push_back(sum);
    }
    for (double& power : powers_)
        power /= sum;
    for (const std::uint32_t i : triangles_)
        per_area_[i] /= sum;
}

EmitterSample Emitters::sample(const glm::dvec3& origin, const glm::dvec2& random) const {
    const auto [at, rest] = sample_sums(powers_, random.x);
    const ModelPlace place{triangles_[at], folded({rest, random.y})};
    const Model& model = model_->model();
    const glm::dvec3 a = corner(model, place.triangle, 0);
    const glm::dvec3 way = a + place.barycentric.x * (corner(model, place.triangle, 1) - a) +
                           place.barycentric.y * (corner(model, place.triangle, 2) - a) - origin;
    EmitterSample found;
    found.triangle = place.triangle;
    found.distance = glm::length(way);
    if (!(found.distance > 1e-9))
        return found;
    found.direction = way / found.distance;
    const glm::dvec3 normal = glm::normalize(area_vector(model, model.triangles[place.triangle]));
    const double cosine = -glm::dot(normal, found.direction);
    if (!(cosine > 1e-9) || model_->is_cut_out(place))
        return found;
    found.light = model_->emission(place);
    found.density = per_area_[place.triangle] * found.distance * found.distance / cosine;
    return found;
}

double Emitters::density(std::uint32_t triangle, const glm::dvec3& origin,
                         const glm::dvec3& direction) const {
    if (empty() || !(per_area_[triangle] > 0.0))
        return 0.0;
    const Model& model = model_->model();
    const glm::dvec3 normal = glm::normalize(area_vector(model, model.triangles[triangle]));
    const double cosine = -glm::dot(normal, direction);
    if (!(cosine > 1e-9))
        return 0.0;
    const double distance = glm::dot(normal, origin - corner(model, triangle, 0)) / cosine;
    return per_area_[triangle] * distance * distance / cosine;
}

} // namespace tessera::corpus
