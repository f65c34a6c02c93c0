// Tests which places of a model get many texels: those that observers come near.
#include "corpus/model_surface/cut_triangles.h"
#include "corpus/model_surface/facets.h"
#include "corpus/model_surface/model_atlas.h"
#include "tests/support/traced_squares.h"

namespace tessera::corpus {
namespace {

using namespace support;

glm::dvec3 middle_of(const Model& model, const ModelTriangle& triangle) {
    glm::dvec3 sum(0.0);
    for (const std::uint32_t vertex : triangle.vertices)
        sum += glm::dvec3(model.vertices[vertex].position) / 3.0;
    return sum;
}

// The length of all edges that belong to one triangle.
double open_edges(const Model& model) {
    const Facets facets = facets_of(model);
    double sum = 0;
    for (std::size_t i = 0; i < model.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            if (facets.neighbours[i][k] < 0) {
                const auto& corners = model.triangles[i].vertices;
                sum += glm::length(glm::dvec3(model.vertices[corners[(k + 1) % 3]].position) -
                                   glm::dvec3(model.vertices[corners[k]].position));
            }
    return sum;
}

TEST(ViewedScale, BodiesOfOneSizeHaveOneDensity) {
    for (const Model& model : {cube_model(), ball_model(12)}) {
        const ViewedScale scale(model);
        EXPECT_FALSE(with_cut_triangles(model, scale));
        for (const double share : viewed_shares(model, scale))
            EXPECT_GT(share, 0.9);
    }
}

TEST(ViewedScale, FloorsAreCutAroundSmallThings) {
    const Model model = cube_on_floor();
    const ViewedScale scale(model);
    const auto cut = with_cut_triangles(model, scale);
    ASSERT_TRUE(cut);
    EXPECT_GT(cut->triangles.size(), 40u);
    EXPECT_LT(cut->triangles.size(), 600u);
    EXPECT_NEAR(surface_area(*cut), surface_area(model), 1e-4);
    EXPECT_NEAR(open_edges(*cut), open_edges(model), 1e-4) << "the floor has gaps";
    for (const ModelTriangle& triangle : cut->triangles)
        for (const std::uint32_t vertex : triangle.vertices)
            if (const ModelVertex& v = cut->vertices[vertex]; v.uv[0] != glm::vec2(0.0f)) {
                EXPECT_EQ(v.uv[0], glm::vec2(v.position.x, v.position.z));
                EXPECT_EQ(v.normal, glm::vec3(0, 1, 0));
            }
    const std::vector<double> shares = viewed_shares(*cut, scale);
    double nearest = 1e9, near_share = 0, least = 1.0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        const double far = glm::length(middle_of(*cut, cut->triangles[i]) - glm::dvec3(cube_place));
        if (i >= 12 && far < nearest) { // the cube comes first
            nearest = far;
            near_share = shares[i];
        }
        least = std::min(least, shares[i]);
    }
    EXPECT_GT(near_share, 0.7);
    EXPECT_LT(least, 0.1);
    EXPECT_GT(least, 1.0 / 256);
}

// The back of a ground faces nothing that observers come near. Both sides of a lone sheet are
// alike.
TEST(ViewedScale, BacksThatFaceNothingHaveFewerTexels) {
    Model ground = cube_on_floor();
    ground.materials[0].double_sided = true;
    Model sheet = ground;
    sheet.triangles.erase(sheet.triangles.begin(), sheet.triangles.begin() + 12); // the cube
    for (const auto& [model, least_gain] : {std::pair{ground, 2.0}, {sheet, 1.0}}) {
        const auto both = with_both_sides(model);
        ASSERT_TRUE(both.ok());
        const std::vector<double> shares = viewed_shares(*both, ViewedScale(*both));
        std::size_t backs = 0;
        for (std::size_t i = 0; i < shares.size(); ++i)
            if (both->triangles[i].is_back) {
                ++backs;
                EXPECT_GE(shares[i - 1], least_gain * shares[i]);
                EXPECT_LE(shares[i - 1], 4.0 * least_gain * shares[i]);
            }
        EXPECT_EQ(backs, 2u);
    }
}

// The part of the texels that is even is that of the texels which charts have in the end.
TEST(ViewedScale, PicturesCountInTheEvenPart) {
    Model model = cube_on_floor();
    const auto least = [&] {
        return std::ranges::min(
            viewed_shares(*with_cut_triangles(model, ViewedScale(model)), ViewedScale(model)));
    };
    model.materials.push_back(model.materials[0]);
    for (std::size_t i = 12; i < model.triangles.size(); ++i)
        model.triangles[i].material = 1;
    const double without = least();
    model.images.push_back({1024, 1024, {}});
    model.materials[1].base_texture.image = 0;
    EXPECT_LT(least(), 0.97 * without);
}

// However small a thing is, and however many large triangles there are, cutting ends soon.
TEST(ViewedScale, WorkIsBounded) {
    Model model = cube_on_floor();
    for (std::size_t i = 0; i < 24; ++i)
        model.vertices[i].position *= 1e-9f;
    // 3,000 triangles share one edge, and as many are the same.
    const std::array<std::uint32_t, 2> edge{24, 25};
    for (std::uint32_t i = 0; i < 3'000; ++i) {
        ModelVertex v = model.vertices[26];
        v.position.y += 1e-4f * static_cast<float>(i);
        model.triangles.push_back(
            {{edge[0], edge[1], static_cast<std::uint32_t>(model.vertices.size())}, 0});
        model.vertices.push_back(v);
        model.triangles.push_back({{24, 26, 25}, 0});
    }
    const std::size_t before = model.triangles.size();
    const ViewedScale scale(model);
    const auto cut = with_cut_triangles(model, scale);
    if (cut)
        EXPECT_LE(cut->triangles.size(), 2 * before + 64);
    EXPECT_EQ(viewed_shares(model, scale).size(), before);
    EXPECT_GE(scale.nearest(), scale.extent() / 2048);
    // No extent at all.
    for (ModelVertex& v : model.vertices)
        v.position = glm::vec3(1.0f);
    const ViewedScale point(model);
    EXPECT_FALSE(with_cut_triangles(model, point));
    for (const double share : viewed_shares(model, point))
        EXPECT_TRUE(share > 0.0 && share <= 1.0);
}

} // namespace
} // namespace tessera::corpus
