#include "corpus/fit/fit_atlas.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::corpus {

Result<double> density_of_pixels(const Model& model, std::span<const PosedPhotograph> photographs) {
    constexpr std::uint32_t rays_per_side = 24;
    constexpr std::size_t most_photographs_tried = 200;
    constexpr double least_cosine = 0.3; // oblique pixels do not resolve more
    std::vector<glm::vec3> positions;
    for (const ModelVertex& vertex : model.vertices)
        positions.push_back(vertex.position);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const ModelTriangle& triangle : model.triangles)
        triangles.push_back(triangle.vertices);
    TESSERA_TRY_ASSIGN(const RayScene rays, RayScene::make(positions, triangles, true));
    std::vector<double> densities;
    const std::size_t count = std::min(photographs.size(), most_photographs_tried);
    for (std::size_t n = 0; n < count; ++n) {
        const PhotoCamera& camera = photographs[n * photographs.size() / count].camera;
        for (std::uint32_t j = 0; j < rays_per_side; ++j)
            for (std::uint32_t i = 0; i < rays_per_side; ++i) {
                const glm::dvec3 d = camera.direction((i + 0.5) * camera.width / rays_per_side,
                                                      (j + 0.5) * camera.height / rays_per_side);
                const auto hit = rays.first_hit(camera.eye, d);
                if (!hit)
                    continue;
                const double cosine = std::abs(glm::dot(
                    glm::normalize(area_vector(model, model.triangles[hit->triangle])), d));
                const double depth = hit->distance * glm::dot(d, camera.axes[2]);
                if (depth > 0.0)
                    densities.push_back(
                        std::sqrt(camera.fx * camera.fy * std::max(cosine, least_cosine)) / depth);
            }
    }
    if (densities.empty())
        return Status(
            ErrorCode::bad_argument,
            "no photograph sees the mesh: are the mesh and the cameras in the same units, "
            "with the same axis up?");
    const auto at = densities.begin() + static_cast<std::ptrdiff_t>(densities.size() * 19 / 20);
    std::nth_element(densities.begin(), at, densities.end());
    return *at;
}

TextureField make_field(const ModelAtlas& atlas, std::uint32_t finer, std::uint32_t directions) {
    TextureField field;
    field.width = atlas.size[0] * finer;
    field.height = atlas.size[1] * finer;
    field.directions = {directions, directions};
    field.charts.assign(field.places(), 0);
    for (std::size_t i = 0; i < atlas.charts.size(); ++i) {
        const Chart& chart = atlas.charts[i];
        for (std::uint32_t y = chart.begin[1] * finer;
             y < (chart.begin[1] + chart.extent[1]) * finer; ++y)
            for (std::uint32_t x = chart.begin[0] * finer;
                 x < (chart.begin[0] + chart.extent[0]) * finer; ++x)
                field.charts[std::size_t{y} * field.width + x] = static_cast<std::uint32_t>(i + 1);
    }
    field.clear();
    return field;
}

TextureField make_shared_field(std::uint32_t directions) {
    TextureField field;
    field.directions = {directions, directions};
    field.charts = {1};
    field.clear();
    return field;
}

std::vector<bool> visible_places(const SurfaceMesh& mesh, const TextureField& field) {
    std::vector<bool> visible(field.places(), false);
    const auto width = static_cast<int>(field.width), height = static_cast<int>(field.height);
    for (const auto& triangle : mesh.triangles) {
        std::array<glm::dvec2, 3> corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = glm::dvec2(mesh.uv[triangle[k]]) * glm::dvec2(width, height);
        visit_covered_texels(corners, {field.width, field.height},
                             [&](std::uint32_t u, std::uint32_t v) {
                                 // Interpolation sees the texels around it, too.
                                 for (int y = std::max(0, static_cast<int>(v) - 1);
                                      y <= std::min(height - 1, static_cast<int>(v) + 1); ++y)
                                     for (int x = std::max(0, static_cast<int>(u) - 1);
                                          x <= std::min(width - 1, static_cast<int>(u) + 1); ++x)
                                         visible[static_cast<std::size_t>(y * width + x)] = true;
                             });
    }
    return visible;
}

} // namespace tessera::corpus
