// Tests models that are textured on their own surfaces: charts, texels, masks.
#include "corpus/model_surface/chart_detail.h"
#include "corpus/model_surface/flat_overlap.h"
#include "corpus/model_surface/model_source.h"
#include "corpus/model_surface/model_truth.h"
#include "tests/support/corpus_support.h"
#include "tests/support/model_files.h"

namespace tessera::corpus {
namespace {

using namespace support;

ModelAtlas atlas_of(const Model& model, double texels) {
    ModelAtlasOptions options;
    options.texels = texels;
    options.tile = {16, 16};
    auto atlas = make_model_atlas(model, options);
    EXPECT_TRUE(atlas.ok()) << atlas.status().message();
    return std::move(*atlas);
}

std::shared_ptr<const LitModel> lit_model(const Model& model, const LitModelOptions& options) {
    auto lit = LitModel::make(atlas_of(model, 1500), white_light(), options);
    EXPECT_TRUE(lit.ok()) << lit.status().message();
    return *lit;
}

// No triangles overlap or have the wrong orientation after decoding.
void expect_no_overlap(const ModelAtlas& atlas) {
    FlatSheet sheet;
    std::size_t covering = 0;
    for (const auto& triangle : atlas.mesh.triangles) {
        FlatTriangle flat;
        for (std::size_t k = 0; k < 3; ++k)
            flat[k] =
                glm::dvec2(atlas.mesh.uv[triangle[k]]) * glm::dvec2(atlas.size[0], atlas.size[1]);
        EXPECT_GT(doubled_area(flat), 0.0);
        covering += !sheet.add(flat);
    }
    EXPECT_EQ(covering, 0u);
}

TEST(ModelSurface, ChartsDoNotOverlap) {
    for (const Model& model : {cube_model(), ball_model(12)}) {
        const ModelAtlas atlas = atlas_of(model, 4000);
        EXPECT_EQ(atlas.mesh.triangles.size(), model.triangles.size());
        expect_no_overlap(atlas);
        EXPECT_LE(atlas.charts.size(), 16u);
        // Stored uv would take more bytes.
        if (atlas.mesh.triangles.size() > 100)
            EXPECT_LT(atlas.stream.size(), encode_mesh(atlas.mesh, {12, 12, 0})->size());
    }
}

// A chart has as many texels as its pictures need, at least half of the density of the finest, and
// all of them have what was asked for.
TEST(ModelSurface, TexelsFollowTheDetailOfPictures) {
    const std::array<double, 3> picture_sides{16, 64, 1024}; // on squares of side 1
    Model model;
    std::vector<FlatChart> charts(3);
    for (std::uint32_t i = 0; i < 3; ++i) {
        const auto side = static_cast<std::uint32_t>(picture_sides[i]);
        model.images.push_back({side, side, {}});
        model.materials.emplace_back();
        model.materials[i].normal_texture.image = static_cast<int>(i);
        const std::uint32_t first = 3 * i;
        for (const glm::vec2 p : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)})
            model.vertices.push_back({.position = {p, 0.0f}, .uv = {p, p}});
        model.triangles.push_back({{first, first + 1, first + 2}, i});
        charts[i] = {.triangles = {i}, .sides = {1, 1}, .shape = {}};
    }
    const double density = shrink_to_detail(charts, model, 20'000, 1.0);
    EXPECT_EQ(charts[2].sides, glm::dvec2(1.0));
    EXPECT_NEAR(charts[1].sides.x * density, 1.4 * 64, density / 256);
    EXPECT_EQ(charts[0].sides.x, 0.5);
    EXPECT_EQ(charts[0].shape.scale, 127);
    double texels = 0;
    for (const FlatChart& chart : charts)
        texels += 0.5 * std::pow(chart.sides.x * density, 2);
    EXPECT_NEAR(texels, 20'000, 200);
    // Without pictures all have the same density.
    for (ModelMaterial& m : model.materials)
        m.normal_texture.image = -1;
    std::vector<FlatChart> plain(3, {.triangles = {0}, .sides = {1, 1}, .shape = {}});
    const double even = shrink_to_detail(plain, model, 15'000, 1.0);
    EXPECT_NEAR(plain[0].sides.x * even, 100.0, 1e-3);
    // One that is viewed from far away leaves texels to the others.
    std::vector<FlatChart> viewed(3, {.triangles = {0}, .sides = {1, 1}, .shape = {}});
    viewed[1].share = 0.25;
    const double nearer = shrink_to_detail(viewed, model, 16'500, 1.0);
    EXPECT_NEAR(viewed[0].sides.x * nearer, 126.5, 0.1);
    EXPECT_EQ(viewed[1].sides.x, 0.25 * viewed[0].sides.x);
}

// Each has a chart with gutters, which count among the texels asked for.
TEST(ModelSurface, LooseTrianglesDoNotGrowTheAtlas) {
    Model model;
    model.materials.emplace_back();
    for (std::uint32_t i = 0; i < 4'000; ++i) {
        const float x = static_cast<float>(i % 64), y = static_cast<float>(i / 64),
                    turn = 0.1f * static_cast<float>(i);
        for (const float angle : {0.0f, 2.0f, 4.0f}) {
            ModelVertex v;
            v.position = {x + 0.3f * std::cos(angle + turn), y + 0.3f * std::sin(angle + turn),
                          0.2f * std::sin(2.0f * angle + turn)};
            v.normal = {0.0f, 0.0f, 1.0f};
            model.vertices.push_back(v);
        }
        model.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, 0});
    }
    ModelAtlasOptions options{.texels = 50'000, .finer = 2, .tile = {16, 16}, .side_step = 32};
    const auto atlas = make_model_atlas(model, options);
    ASSERT_TRUE(atlas.ok());
    EXPECT_EQ(atlas->charts.size(), 4'000u);
    EXPECT_LT(1.0 * atlas->size[0] * atlas->size[1], 1.75 * options.texels);
    EXPECT_LE(atlas->size[1], 4 * atlas->size[0] + 4096);
}

// Squares of side 1, each with its own vertices, in rows of 32.
Model loose_squares(std::uint32_t count) {
    Model model;
    model.materials.emplace_back();
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(i % 32), y = static_cast<float>(i / 32);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const auto right = static_cast<float>(k % 2), up = static_cast<float>(k / 2);
            ModelVertex v;
            v.position = {x + right, y + up, 0.0f};
            v.normal = {0.0f, 0.0f, 1.0f};
            model.vertices.push_back(v);
        }
        model.triangles.push_back({{4 * i, 4 * i + 1, 4 * i + 2}, 0});
        model.triangles.push_back({{4 * i + 1, 4 * i + 3, 4 * i + 2}, 0});
    }
    return model;
}

TEST(ModelSurface, LooseTrianglesShareCharts) {
    // 2000 triangles without common vertices, on both sides, as in models of foliage.
    Model model = loose_squares(1000);
    const std::vector<ModelTriangle> fronts = std::move(model.triangles);
    model.triangles.clear();
    for (const ModelTriangle& t : fronts) {
        model.triangles.push_back(t);
        model.triangles.push_back({{t.vertices[0], t.vertices[2], t.vertices[1]}, 0});
    }
    EXPECT_LE(cut_flat(model).size(), 2u);
    expect_no_overlap(atlas_of(model, 4000));
    EXPECT_EQ(cut_flat(cube_model()).size(), 6u); // not across sharp edges
}

// Rounding is relative to the box around the triangles.
TEST(ModelSurface, UnusedVerticesDoNotCount) {
    Model model = ball_model(12);
    const ModelAtlas atlas = atlas_of(model, 4000);
    ModelVertex far;
    far.position = glm::vec3(1e6f);
    model.vertices.insert(model.vertices.begin(), far);
    for (ModelTriangle& triangle : model.triangles)
        for (std::uint32_t& vertex : triangle.vertices)
            ++vertex;
    EXPECT_EQ(atlas_of(model, 4000).stream, atlas.stream);
}

// Thousands of triangles that are smaller than the rounding, beside a large one.
TEST(ModelSurface, TinyTrianglesAreFoundAgain) {
    Model model = loose_squares(2000);
    for (ModelVertex& vertex : model.vertices)
        vertex.position *= 1e-6f;
    const auto first = static_cast<std::uint32_t>(model.vertices.size());
    for (const glm::vec2 p : {glm::vec2(0, 0), glm::vec2(100, 0), glm::vec2(0, 100)})
        model.vertices.push_back({.position = {p, 1.0f}, .normal = {0.0f, 0.0f, 1.0f}});
    model.triangles.push_back({{first, first + 1, first + 2}, 0});
    const ModelAtlas atlas = atlas_of(model, 4000);
    EXPECT_EQ(atlas.mesh.triangles.size(), model.triangles.size());
    EXPECT_EQ(atlas.model.triangles.size(), model.triangles.size());
}

TEST(ModelSurface, EdgesJoinTrianglesAtTheSamePosition) {
    Model model = loose_squares(2);
    model.vertices[4].position.y += 1e-7f; // rounded in another way
    const Facets facets = facets_of(model);
    EXPECT_EQ(facets.neighbours[1], (std::array<std::int64_t, 3>{2, -1, 0}));
    EXPECT_EQ(facets.neighbours[2], (std::array<std::int64_t, 3>{-1, 3, 1}));
    // Between fronts and backs, a front continues into a front.
    Model both = model;
    both.triangles.clear();
    for (const ModelTriangle& t : model.triangles) {
        both.triangles.push_back(t);
        both.triangles.push_back({{t.vertices[0], t.vertices[2], t.vertices[1]}, 0});
    }
    const Facets sides = facets_of(both);
    EXPECT_EQ(sides.neighbours[2], (std::array<std::int64_t, 3>{4, -1, 0}));
    EXPECT_EQ(sides.neighbours[4], (std::array<std::int64_t, 3>{-1, 6, 2}));
}

TEST(ModelSurface, SheetsTakeTrianglesOfAnySizeAnywhere) {
    FlatSheet sheet;
    EXPECT_TRUE(sheet.add({{{0, 0}, {10'000, 0}, {10'000, 10'000}}}));
    for (const double far : {-1e8, -1e4, 2e4, 1e8})
        EXPECT_TRUE(sheet.add({{{far, far}, {far + 1, far}, {far, far + 1}}})) << far;
    // With cells as large as the others, this one would lie in 1e12 of them.
    EXPECT_TRUE(sheet.add({{{0, -1e3}, {1e12, -1e3}, {1e12, -1}}}));
    EXPECT_FALSE(sheet.add({{{5000, 1000}, {5000.01, 1000}, {5000, 1000.01}}}));
    EXPECT_TRUE(sheet.add({{{1000, 5000}, {1000.01, 5000}, {1000, 5000.01}}}));
    EXPECT_FALSE(sheet.add({{{900, 4900}, {1100, 4900}, {1000, 5100}}}));
}

TEST(ModelSurface, CornersKeepTheirAttributes) {
    Model model = ball_model(6);
    for (ModelVertex& v : model.vertices)
        v.colour = glm::vec4(v.position, 1.0f);
    for (const ModelVertex& v : atlas_of(model, 1000).model.vertices)
        EXPECT_LT(glm::length(glm::vec3(v.colour) - v.position), 0.01f);
}

TEST(ModelSurface, SameBytesForAnyBoxAndThreadCount) {
    const Model model = ball_model(6);
    LitModelOptions options;
    options.samples = 2;
    options.diffuse_samples = options.shared_samples = 4;
    const auto one = lit_model(model, options);
    options.threads = 3;
    const auto three = lit_model(model, options);
    for (const AngularMap map :
         {AngularMap::octahedral_hemisphere, AngularMap::octahedral_mirrored}) {
        auto a = make_model_source(one, map, {3, 2}, {});
        auto b = make_model_source(three, map, {3, 2}, {});
        ASSERT_TRUE(a.ok() && b.ok());
        const TextureDesc& desc = (*a)->desc();
        const Bytes whole = read_box(**a, Box4::whole(desc.size));
        auto random = generator(5);
        for (int i = 0; i < 12; ++i) {
            Box4 box;
            for (std::size_t axis = 0; axis < 4; ++axis) {
                box.begin[axis] = static_cast<std::uint32_t>(random() % desc.size[axis]);
                box.end[axis] =
                    box.begin[axis] + 1 +
                    static_cast<std::uint32_t>(
                        random() % std::min<std::uint64_t>(20, desc.size[axis] - box.begin[axis]));
            }
            Bytes part(desc.box_bytes(box));
            copy_box(box, Box4::whole(desc.size), whole, box, part, desc.texel_bytes());
            EXPECT_EQ(read_box(**b, box), part);
        }
    }
}

TEST(ModelSurface, TexelsAgreeWithTheTruth) {
    // In white light the colour of a ball depends only on the angle of view, so that the texture
    // can be compared with the truth.
    Model model = ball_model(16);
    model.materials[0].metal = 0.0;
    model.materials[0].roughness = 0.7;
    LitModelOptions options;
    options.samples = 16;
    const auto lit = lit_model(model, options);
    auto truth = make_model_truth(model, white_light(), {1.0, SampleType::half16}, 256);
    ASSERT_TRUE(truth.ok());
    const auto seen = (*truth)->see({0.1, 0.2, 9}, {0, 0, -1}, 1);
    ASSERT_TRUE(seen);
    EXPECT_FALSE((*truth)->see({5, 0.2, 9}, {0, 0, -1}, 1));
    double sum = 0;
    int count = 0;
    for (std::uint32_t v = 0; v < lit->places().size()[1]; v += 5)
        for (std::uint32_t u = 0; u < lit->places().size()[0]; u += 5)
            if (lit->matters(u, v)) {
                sum += lit->light(u, v, AngularMap::octahedral_hemisphere, 0.5, 0.5,
                                  *lit->arriving(u, v))
                           .x;
                ++count;
            }
    EXPECT_GT(count, 20);
    EXPECT_NEAR(sum / count, seen->x, 0.02);
}

TEST(ModelSurface, HiddenSurfacesAndBacksAreNotSeen) {
    // A cube inside another cube is hidden.
    Model model = cube_model();
    const auto count = static_cast<std::uint32_t>(model.vertices.size());
    const std::size_t triangles = model.triangles.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        model.vertices.push_back(model.vertices[i]);
        model.vertices.back().position *= 0.5f;
    }
    for (std::size_t i = 0; i < triangles; ++i) {
        ModelTriangle t = model.triangles[i];
        for (std::uint32_t& v : t.vertices)
            v += count;
        model.triangles.push_back(t);
    }
    LitModelOptions options;
    options.samples = options.diffuse_samples = options.shared_samples = 1;
    const auto lit = lit_model(model, options);
    std::size_t all = 0, seen = 0;
    for (std::uint32_t v = 0; v < lit->places().size()[1]; ++v)
        for (std::uint32_t u = 0; u < lit->places().size()[0]; ++u) {
            all += lit->places().matters(u, v);
            seen += lit->matters(u, v);
        }
    EXPECT_LT(seen, all);
    EXPECT_GT(seen, all / 2);
    // A closed model has no back faces to bake, whatever its material declares. An open one has.
    Model closed = cube_model();
    closed.materials[0].double_sided = true;
    EXPECT_EQ(with_both_sides(closed)->triangles.size(), 12u);
    closed.triangles.resize(10);
    EXPECT_EQ(with_both_sides(closed)->triangles.size(), 20u);
    closed.materials[0].cutoff = 0.5; // an alpha mask that removes everything
    closed.materials[0].base.a = 0.25;
    EXPECT_EQ(with_both_sides(closed).status().code(), ErrorCode::invalid_file);
}

TEST(ModelSurface, NoiseFallsWithSamples) {
    Model model = ball_model(8);
    model.materials[0].roughness = 0.5;
    const auto noise = [&](unsigned samples) {
        LitModelOptions options;
        options.samples = options.diffuse_samples = options.shared_samples = samples;
        auto lit = LitModel::make(atlas_of(model, 300),
                                  {std::make_shared<const Environment>(Environment::studio()), {}},
                                  options);
        EXPECT_TRUE(lit.ok());
        return estimate_noise(**lit, AngularMap::octahedral_hemisphere, {4, 4}, {}, samples, 100);
    };
    const NoiseEstimate few = noise(4), many = noise(64);
    EXPECT_GT(many.decibels, few.decibels + 8.0);
    EXPECT_GE(few.samples_for(few.decibels + 10.0), 39.0);
}

// On a ball, highlights stay in the same cells of the mirrored map. A surface without angular
// variation gains nothing from that map.
TEST(ModelSurface, AngularMapsAreChosenByTrial) {
    const auto chosen = [](Model model, float metal, float roughness) {
        model.materials[0].metal = metal;
        model.materials[0].roughness = roughness;
        LitModelOptions options;
        options.samples = options.shared_samples = options.diffuse_samples = 16;
        auto lit = LitModel::make(atlas_of(model, 300),
                                  {std::make_shared<const Environment>(Environment::studio()), {}},
                                  options);
        EXPECT_TRUE(lit.ok());
        return choose_angular_map(**lit, {}, {16, 16});
    };
    EXPECT_EQ(chosen(ball_model(12), 1, 0.4f), AngularMap::octahedral_mirrored);
    EXPECT_EQ(chosen(cube_model(), 0, 1), AngularMap::octahedral_hemisphere);
}

} // namespace
} // namespace tessera::corpus
