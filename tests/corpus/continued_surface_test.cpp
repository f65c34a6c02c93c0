// Tests that texels beside a triangle show where the surface continues.
#include "corpus/layers/place_light.h"
#include "corpus/model_surface/continued_surface.h"
#include "corpus/model_surface/cut_triangles.h"
#include "corpus/model_surface/facets.h"
#include "corpus/model_surface/triangle_sides.h"
#include "tests/support/traced_squares.h"

#include <cmath>
#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

glm::dvec3 position_of(const Model& model, const ModelPlace& place) {
    return place_on(model, model.triangles[place.triangle], place.barycentric);
}

// Strips of two triangles that meet at edges along z, each turned by `angle` against the one before,
// with smooth normals or those of the strips.
Model bent_strips(std::size_t count, double angle, bool smooth) {
    Model model;
    model.materials.resize(2);
    glm::dvec2 at(0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const double own = angle * static_cast<double>(i);
        const glm::dvec2 next = at + glm::dvec2(std::cos(own), std::sin(own));
        const auto first = static_cast<std::uint32_t>(model.vertices.size());
        for (int k = 0; k < 4; ++k) {
            ModelVertex v;
            const glm::dvec2 p = k < 2 ? at : next;
            v.position = {p.x, p.y, k % 2};
            const double turned = smooth ? own + (k < 2 ? -0.5 : 0.5) * angle : own;
            v.normal = {-std::sin(turned), std::cos(turned), 0};
            model.vertices.push_back(v);
        }
        model.triangles.push_back({{first, first + 1, first + 2}, 0});
        model.triangles.push_back({{first + 2, first + 1, first + 3}, 0});
        at = next;
    }
    return model;
}

TEST(ContinuedSurface, PlacesOnAPlaneStayWhereTheyAre) {
    const Model model = bent_strips(5, 0.0, true);
    const ContinuedSurface surface(model);
    for (const glm::dvec2 beside : {glm::dvec2(0.2, 0.3), glm::dvec2(0.1, 2.5),
                                    glm::dvec2(0.6, 0.6), glm::dvec2(0.99, 4.95)}) {
        const ModelPlace from{0, beside}, to = surface.walk(from);
        const glm::dvec3 way = position_of(model, to) - position_of(model, from);
        EXPECT_NEAR(glm::length(way), 0.0, 1e-6);
        EXPECT_GE(std::min({to.barycentric.x, to.barycentric.y,
                            1.0 - to.barycentric.x - to.barycentric.y}),
                  -1e-9);
    }
}

TEST(ContinuedSurface, WaysBendWithTheSurface) {
    const Model model = bent_strips(4, 0.3, true);
    const ContinuedSurface surface(model);
    // 2.5 strips along x, within their height and, where no triangle continues them, below it.
    for (const double z : {0.25, -0.1}) {
        const ModelPlace to = surface.walk({0, {z, 2.5}});
        EXPECT_EQ(to.triangle / 2, 2u);
        const glm::dvec3 p = position_of(model, to);
        EXPECT_NEAR(p.x, 1 + std::cos(0.3) + 0.5 * std::cos(0.6), 1e-6);
        EXPECT_NEAR(p.y, std::sin(0.3) + 0.5 * std::sin(0.6), 1e-6);
        EXPECT_NEAR(p.z, z, 1e-6);
    }
}

TEST(ContinuedSurface, WaysEndAtCreasesAndOtherMaterials) {
    const ModelPlace beside{1, {-0.25, 0.75}};
    Model model = bent_strips(3, 0.3, true);
    EXPECT_EQ(ContinuedSurface(model).walk(beside).triangle, 2u);
    for (std::size_t i = 2; i < 6; ++i)
        model.triangles[i].material = 1;
    EXPECT_EQ(ContinuedSurface(model).walk(beside).triangle, 1u);
    const Model creased = bent_strips(3, 0.3, false);
    EXPECT_EQ(ContinuedSurface(creased).walk(beside).triangle, 1u);
    const Model sharp = bent_strips(3, 1.0, true);
    EXPECT_EQ(ContinuedSurface(sharp).walk(beside).triangle, 1u);
}

// The light of the sky on a floor under a card, where charts of different density meet.
TEST(ContinuedSurface, LightIsTheSameOnBothSidesOfAnEdge) {
    Model model = cube_on_floor();
    const std::size_t card = model.vertices.size();
    add_square(model, 25.0f * cube_side, 8.0f * cube_side, false, 0);
    add_square(model, 25.0f * cube_side, 8.0f * cube_side, true, 0);
    for (std::size_t i = card; i < model.vertices.size(); ++i)
        model.vertices[i].position += cube_place;
    model.materials[0].base = {0, 0, 0, 1};
    model.materials[0].metal = 0;
    const ViewedScale viewed(model);
    const auto cut = with_cut_triangles(model, viewed);
    ASSERT_TRUE(cut);
    auto atlas =
        make_model_atlas(*cut, {.texels = 5'000, .finer = 2, .viewed = &viewed, .tile = {16, 16}});
    ASSERT_TRUE(atlas.ok());
    const SurfaceMesh mesh = atlas->mesh;
    auto places = ModelPlaces::make(std::move(*atlas));
    ASSERT_TRUE(places.ok());
    const ModelLight light = white_light();
    auto lit = PlaceLight::make(*places, Tracer(places->model(), light), DistantLights(light, 4),
                                {.diffuse_samples = 2, .shadow_samples = 1000}, {.threads = 2});
    ASSERT_TRUE(lit.ok());
    const Model& own = places->model()->model();
    const Facets facets = facets_of(own);
    const auto light_at = [&](std::size_t triangle, std::size_t corner, double share) {
        glm::dvec2 texel(0.0);
        for (const auto& [k, weight] : {std::pair{corner, 1.0 - share}, {corner + 1, share}})
            texel += weight * glm::dvec2(mesh.uv[mesh.triangles[triangle][k % 3]]);
        const Texels2 size = places->texel_places().size();
        return lit->diffuse(texel * glm::dvec2(size[0], size[1]),
                            places->texel_places().chart_of(triangle), facets.normals[triangle]);
    };
    double most = 0, sum = 0, count = 0, darkest = 1;
    for (std::size_t i = 0; i < own.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t other = facets.neighbours[i][k];
            if (other <= static_cast<std::int64_t>(i))
                continue;
            const auto j = static_cast<std::size_t>(other);
            if (places->texel_places().chart_of(i) == places->texel_places().chart_of(j) ||
                glm::dot(facets.normals[i], facets.normals[j]) < 0.99)
                continue;
            std::size_t back = 0;
            while (facets.neighbours[j][back] != static_cast<std::int64_t>(i))
                ++back;
            for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                const auto a = light_at(i, k, share), b = light_at(j, back, 1.0 - share);
                ASSERT_TRUE(a && b);
                const double step = std::abs(a->x - b->x);
                darkest = std::min(darkest, a->x);
                most = std::max(most, step);
                sum += step;
                ++count;
            }
        }
    ASSERT_GT(count, 20.0);
    EXPECT_LT(darkest, 0.1);
    EXPECT_LT(sum / count, 0.0028);
    EXPECT_LT(most, 0.0175);
}

} // namespace
} // namespace tessera::corpus
