// Tests models that are baked into layers.
#include "corpus/layers/clear_walls.h"
#include "corpus/layers/layer_density.h"
#include "corpus/layers/model_layers.h"
#include "tests/support/baked_layers.h"
#include "tests/support/traced_squares.h"

#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

// A convex body in uniform light sees all lights and leaves the same diffuse light everywhere.
TEST(ModelLayers, ConvexBodiesAreLitEvenly) {
    Model model = ball_model(12);
    model.materials[0].base = {0.5, 0.25, 0.125, 1};
    model.materials[0].metal = 0;
    model.materials[0].roughness = 0.5;
    ModelLayersOptions options = quick();
    options.light.shadow_samples = 1020;
    const ModelLayers layers = baked(model, white_light(), options);
    const LayerTexture& diffuse = layer(layers, LayerRole::diffuse);
    std::size_t count = 0;
    for (std::size_t i = 0; i < diffuse.mask.size(); ++i) {
        if (diffuse.mask[i] == std::byte{0})
            continue;
        ++count;
        for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(diffuse.scale *
                            srgb_to_linear(std::to_integer<int>(diffuse.texels[3 * i + c]) / 255.0),
                        0.96 * 0.5 / (1 << c), 0.05)
                << i;
    }
    EXPECT_GT(count, 3000u);
    const LayerTexture& roughness = layer(layers, LayerRole::roughness);
    const LayerTexture& specular = layer(layers, LayerRole::specular);
    for (std::size_t i = 0; i < count; ++i)
        if (diffuse.mask[i] != std::byte{0}) {
            ASSERT_EQ(std::to_integer<int>(roughness.texels[i]), 128);
            ASSERT_NEAR(srgb_to_linear(std::to_integer<int>(specular.texels[3 * i]) / 255.0), 0.04,
                        0.002);
        }
    // A light above the horizon is seen, and one below it is not.
    const LayerTexture& visibility = layer(layers, LayerRole::visibility);
    const auto peaks = visibility_peaks(layers.lights);
    std::array<std::size_t, 2> seen{};
    for (std::size_t i = 0; i < visibility.mask.size(); ++i)
        if (visibility.mask[i] != std::byte{0} && i % 4 < peaks.size()) {
            const double share = std::to_integer<int>(visibility.texels[i]) / 255.0 / peaks[i % 4];
            ++seen[share > 0.5];
        }
    EXPECT_GT(seen[1], seen[0]);
    // It sees nothing of itself.
    for (const std::byte b : layer(layers, LayerRole::reflection).texels)
        ASSERT_EQ(b, std::byte{0});
}

// Alpha masks become coverage, and what they remove is masked in the other layers.
TEST(ModelLayers, CoverageFollowsAlphaMasks) {
    Model model = cube_model();
    model.materials[0].cutoff = 0.5;
    for (ModelVertex& v : model.vertices)
        v.colour.a = v.position.y > 0 ? 1.0f : 0.0f;
    const ModelLayers layers = baked(model, white_light(), quick());
    const LayerTexture& coverage = layer(layers, LayerRole::coverage);
    const LayerTexture& diffuse = layer(layers, LayerRole::diffuse);
    std::array<double, 2> covered{}; // by whether the texel is
    for (std::size_t i = 0; i < coverage.mask.size(); ++i)
        if (coverage.mask[i] != std::byte{0}) {
            const bool is_covered = coverage.texels[i] > std::byte{127};
            ++covered[is_covered];
            if (coverage.texels[i] == std::byte{0})
                ASSERT_EQ(diffuse.mask[i], std::byte{0});
            if (is_covered)
                ASSERT_EQ(diffuse.mask[i], std::byte{1});
        }
    // The upper halves of four sides and the top are left: half of the faces seen from outside.
    EXPECT_NEAR(covered[1] / (covered[0] + covered[1]), 0.5, 0.05);
    for (const LayerTexture& other : baked(cube_model(), white_light(), quick()).layers)
        EXPECT_NE(other.role, LayerRole::coverage);
}

// Blending becomes opacity. The other layers hold the light of the surface itself, except where it
// is invisible.
TEST(ModelLayers, OpacityFollowsBlending) {
    Model model = cube_model();
    model.materials[0].metal = 0;
    model.materials[0].roughness = 1;
    model.materials[0].blends = true;
    for (ModelVertex& v : model.vertices)
        v.colour.a = v.position.y > 0 ? 0.5f : 0.0f;
    const ModelLayers layers = baked(model, white_light(), quick());
    const LayerTexture& opacity = layer(layers, LayerRole::opacity);
    const LayerTexture& diffuse = layer(layers, LayerRole::diffuse);
    double invisible = 0, half = 0, sum = 0, count = 0;
    for (std::size_t i = 0; i < opacity.mask.size(); ++i)
        if (opacity.mask[i] != std::byte{0}) {
            const double o = std::to_integer<int>(opacity.texels[i]) / 255.0;
            EXPECT_LT(o, 0.51);
            sum += o;
            ++count;
            half += o > 0.49;
            invisible += diffuse.mask[i] == std::byte{0};
            if (o > 0.0)
                ASSERT_EQ(diffuse.mask[i], std::byte{1});
            if (diffuse.mask[i] != std::byte{0})
                ASSERT_GT(diffuse.scale *
                              srgb_to_linear(std::to_integer<int>(diffuse.texels[3 * i]) / 255.0),
                          0.8)
                    << i;
        }
    // The sides fade from half to nothing.
    EXPECT_NEAR(sum / count, (0.5 + 4 * 0.25) / 6, 0.01);
    EXPECT_NEAR(half / count, 1.0 / 6, 0.06); // and the uppermost texels of the sides
    EXPECT_GT(invisible, 0.0);
    for (const LayerTexture& other : baked(cube_model(), white_light(), quick()).layers)
        EXPECT_NE(other.role, LayerRole::opacity);
}

// A card that is half transparent halves the visibility of a light and the diffuse light below it.
TEST(ModelLayers, HalfTransparentCardsCastHalfAShadow) {
    Model model;
    model.materials.resize(2);
    model.materials[0].metal = 0;
    model.materials[1].base = {0, 0, 0, 0.5};
    model.materials[1].blends = true;
    add_square(model, 2, 0, false, 0);
    add_square(model, 4, 1, false, 1);
    add_square(model, 4, 1, true, 1);
    ModelLayersOptions options = quick();
    options.texels = 2000;
    const ModelLayers layers =
        baked(model, {uniform_environment(0.001f), Sun{{0, 1, 0}, glm::dvec3(3.0)}}, options);
    const LayerTexture& visibility = layer(layers, LayerRole::visibility);
    const std::size_t sun = layers.lights.size() - 1,
                      stride = texel_count(visibility.desc.size) /
                               (visibility.desc.size[axis_u] * visibility.desc.size[axis_v]);
    ASSERT_EQ(layers.lights[sun].spread, 0.0f);
    const double peak = visibility_peaks(layers.lights)[sun];
    double half = 0, whole = 0;
    for (std::size_t i = sun; i < visibility.mask.size(); i += stride)
        if (visibility.mask[i] != std::byte{0}) {
            const double share = std::to_integer<int>(visibility.texels[i]) / 255.0 / peak;
            half += share > 0.45 && share < 0.55;
            whole += share > 0.9;
        }
    EXPECT_NEAR(half / whole, 0.25, 0.15); // their areas, with the texels around them
    const LayerTexture& diffuse = layer(layers, LayerRole::diffuse);
    double brightest = 0;
    for (const std::byte x : diffuse.texels)
        brightest = std::max(brightest, srgb_to_linear(std::to_integer<int>(x) / 255.0));
    EXPECT_NEAR(brightest * diffuse.scale, 0.5 * 3.0 * 0.96 / std::numbers::pi, 0.03);
}

// Beside bright light, errors of emission hardly show, so it takes fewer bytes.
TEST(ModelLayers, QualityOfEmissionFollowsWhatADisplayShows) {
    Model model = ball_model(8);
    model.materials[0].metal = 0;
    model.materials[0].roughness = 1;
    ModelLayersOptions options = quick();
    options.texels = 1000;
    options.light.diffuse_samples = 8;
    const auto quality = [&](double emission, float light) {
        model.materials[0].emission = glm::dvec3(emission);
        const ModelLayers layers = baked(model, {uniform_environment(light)}, options);
        return layer(layers, LayerRole::emission).quality_change;
    };
    EXPECT_NEAR(quality(1.0, 0.0f), 0.0, 1.0);
    EXPECT_LT(quality(0.2, 0.5f), -10.0);
    EXPECT_GE(quality(0.2, 2.0f), -20.0); // all is white
}

// Scans are often unlit (KHR_materials_unlit): nothing but their colour is seen.
TEST(ModelLayers, UnlitSurfacesShowTheirColourAlone) {
    Model model = ball_model(8);
    ModelMaterial& m = model.materials[0];
    m.base = {0.5, 0.25, 0.0, 1};
    m.is_unlit = true;
    m.unlit_light = 1.0;
    ModelLayersOptions options = quick();
    options.texels = 1000;
    options.light.diffuse_samples = 8;
    const auto expect_colour = [&](const ModelLayers& layers, const char* what) {
        const LayerTexture& emission = layer(layers, LayerRole::emission);
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < emission.mask.size(); ++i)
            if (const int code = std::to_integer<int>(emission.texels[3 * i]); code != 0) {
                sum += emission.scale * srgb_to_linear(code / 255.0);
                ++count;
            }
        ASSERT_GT(count, 0) << what;
        EXPECT_NEAR(sum / count, 0.5, 0.03) << what; // texels on borders are mixed
    };
    const ModelLayers alone = baked(model, white_light(), options);
    expect_colour(alone, "alone");
    EXPECT_EQ(alone.layers.size(), 2u); // diffuse light, which is black, and emission
    EXPECT_TRUE(alone.lights.empty());
    // Beside a surface that mirrors, no light is seen in an unlit one.
    ModelMaterial mirror = model.materials[0];
    mirror.is_unlit = false;
    model.materials.push_back(mirror);
    for (std::size_t i = 0; i < model.triangles.size() / 2; ++i)
        model.triangles[i].material = 1;
    const ModelLayers beside = baked(model, white_light(), options);
    expect_colour(beside, "beside a mirror");
    const auto lit = [&](const ModelLayers& layers) {
        const LayerTexture& visibility = layer(layers, LayerRole::visibility);
        return visibility.texels.size() - std::ranges::count(visibility.texels, std::byte{0});
    };
    const auto half = static_cast<double>(lit(beside));
    const auto whole = static_cast<double>(lit(baked(ball_model(8), white_light(), options)));
    EXPECT_NEAR(half, 0.5 * whole, 0.1 * whole);
}

TEST(ModelLayers, ClearWallsBlend) {
    Model model;
    model.materials.resize(3);
    for (ModelMaterial& m : model.materials) {
        m.base = {1.0, 0.5, 0.5, 1.0};
        m.metal = m.roughness = 0.0;
        m.coats = ModelCoats{};
        m.coats->through = 0.5;
    }
    model.materials[1].roughness = 0.3;
    model.materials[2].coats->is_volume = true;
    make_clear_walls_blend(model);
    const ModelMaterial& wall = model.materials[0];
    EXPECT_TRUE(wall.blends);
    EXPECT_EQ(wall.coats->through, 0.0);
    EXPECT_NEAR(wall.base.a, 1.0 - 0.5 * 0.6063 * 0.96, 1e-6);
    EXPECT_NEAR(wall.base.a * wall.reflectance, 0.04, 1e-12);
    EXPECT_NEAR(wall.base.a * wall.base.r, 0.5, 1e-12);
    EXPECT_FALSE(model.materials[1].blends);
    EXPECT_FALSE(model.materials[2].blends);
}

// Rounded positions of few triangles move edges that all views show.
TEST(ModelLayers, FewTrianglesHaveExactPositions) {
    Model model = cube_model();
    for (ModelVertex& vertex : model.vertices)
        vertex.position *= glm::vec3(1.0f, 0.731f, 0.317f);
    const ModelLayers layers = baked(model, white_light(), quick());
    double worst = 0;
    for (const glm::vec3& found : layers.decoded_mesh.positions) {
        double nearest = 1e9;
        for (const ModelVertex& vertex : model.vertices)
            nearest = std::min(nearest, static_cast<double>(glm::distance(found, vertex.position)));
        worst = std::max(worst, nearest);
    }
    EXPECT_LT(worst, 1e-4 * bounds_of(layers.decoded_mesh).diagonal());
}

// Who cannot see highlights needs no exact visibility.
TEST(ModelLayers, VisibilityIsAsExactAsHighlightsAreBright) {
    Model model = cube_model();
    model.materials[0].metal = 0.0;
    model.materials[0].roughness = 1.0;
    const ModelLight light{std::make_shared<const Environment>(Environment::studio()), {}};
    ModelLayersOptions options = quick();
    options.directions = Texels2{2, 2};
    const auto change = [&] {
        return layer(baked(model, light, options), LayerRole::visibility).quality_change;
    };
    const double dull = change();
    model.materials[0].metal = 1.0;
    model.materials[0].roughness = 0.3;
    EXPECT_LT(dull, change() - 5.0);
}

// The bytes depend on the arguments only.
TEST(ModelLayers, DoNotDependOnThreads) {
    const ModelLight light{std::make_shared<const Environment>(Environment::studio()), {}};
    ModelLayersOptions options = quick();
    options.texels = 2000;
    options.light.diffuse_samples = 8;
    const ModelLayers two = baked(cube_model(), light, options);
    options.run.threads = 1;
    const ModelLayers one = baked(cube_model(), light, options);
    ASSERT_EQ(one.layers.size(), two.layers.size());
    EXPECT_TRUE(one.mesh == two.mesh);
    for (std::size_t i = 0; i < one.layers.size(); ++i) {
        EXPECT_TRUE(one.layers[i].texels == two.layers[i].texels);
        EXPECT_TRUE(one.layers[i].mask == two.layers[i].mask);
    }
}

// More paths are traced until the noise is as asked for. The lamp lights the
// ceiling, and the ceiling the floor.
TEST(ModelLayers, NoiseFollowsItsOption) {
    Model model;
    model.materials.resize(2);
    for (ModelMaterial& m : model.materials)
        m.metal = 0;
    model.materials[1].emission = glm::dvec3(4.0);
    add_square(model, 2, 0, false, 0);
    add_square(model, 3, 1, true, 0);       // a ceiling
    add_square(model, 0.5, 0.6f, false, 1); // a lamp that shines on it
    ModelLayersOptions options = quick();
    options.texels = 4000;
    options.light.diffuse_samples = 4;
    const auto noise = [&](double asked) {
        options.light.noise = asked;
        return baked(model, {uniform_environment(0.0f)}, options).noise;
    };
    const double rough = noise(10.0), fine = noise(60.0);
    EXPECT_GT(fine, rough + 4.0);
    EXPECT_GT(rough, 15.0);
}

// So that readers have mips, which need tiles that begin at even texels.
TEST(ModelLayers, FinestLayersAreWholeTiles) {
    for (const std::uint32_t light_texel : {1u, 2u, 4u}) {
        ModelLayersOptions options = quick();
        options.light_texel = light_texel;
        const LayerTexture diffuse = baked(cube_model(), white_light(), options).layers[0];
        EXPECT_EQ(diffuse.desc.size[axis_u] % diffuse.tile[axis_u], 0u) << light_texel;
        EXPECT_EQ(diffuse.desc.size[axis_v] % diffuse.tile[axis_v], 0u) << light_texel;
    }
}

// Models with pictures of many texels have more texels, but no more of light.
TEST(ModelLayers, TexelsFollowPictures) {
    Model model;
    model.materials.emplace_back();
    add_square(model, 1.0f, 0.0f, false, 0);
    for (std::size_t i = 0; i < 4; ++i)
        model.vertices[i].uv[0] = {i % 2, i / 2};
    EXPECT_EQ(layer_density(model).texels, 1e6);
    model.materials[0].base_texture.image = 0;
    model.images.push_back({512, 512, {}});
    EXPECT_EQ(layer_density(model).texels, 1e6);
    model.images[0] = {512, 1024, {}};
    EXPECT_NEAR(layer_density(model).texels, 3.0 * 512 * 1024, 1.0);
    model.images[0] = {1024, 1024, {}};
    EXPECT_EQ(layer_density(model).texels, 2e6);
    EXPECT_EQ(layer_density(model).light_texel, 2u);
    model.images[0].width = model.images[0].height = 2048;
    EXPECT_EQ(layer_density(model).texels, 4e6);
    EXPECT_EQ(layer_density(model).light_texel, 4u);
    EXPECT_EQ(layer_density(model, 3e6).texels, 3e6);
    EXPECT_EQ(layer_density(model, 3e6).light_texel, 2u);
}

// The diffuse light of the texel at a place that faces upwards.
double light_above(const ModelLayers& layers, const glm::dvec2& place) {
    const SurfaceMesh& mesh = layers.decoded_mesh;
    const LayerTexture& diffuse = layer(layers, LayerRole::diffuse);
    for (const auto& triangle : mesh.triangles) {
        std::array<glm::dvec2, 3> p, uv;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::dvec3 corner(mesh.positions[triangle[k]]);
            p[k] = {corner.x, corner.z};
            uv[k] = glm::dvec2(mesh.uv[triangle[k]]);
        }
        const glm::dvec2 b = p[1] - p[0], c = p[2] - p[0], d = place - p[0];
        const double area = b.x * c.y - b.y * c.x;
        const double of_b = (d.x * c.y - d.y * c.x) / area, of_c = (b.x * d.y - b.y * d.x) / area;
        if (!(area < 0.0) || of_b < 0.0 || of_c < 0.0 || of_b + of_c > 1.0)
            continue;
        const glm::dvec2 at = uv[0] + of_b * (uv[1] - uv[0]) + of_c * (uv[2] - uv[0]);
        const auto u = static_cast<std::size_t>(at.x * diffuse.desc.size[axis_u]),
                   v = static_cast<std::size_t>(at.y * diffuse.desc.size[axis_v]);
        const std::size_t texel = v * diffuse.desc.size[axis_u] + u;
        EXPECT_NE(diffuse.mask[texel], std::byte{0});
        return diffuse.scale *
               srgb_to_linear(std::to_integer<int>(diffuse.texels[3 * texel]) / 255.0);
    }
    ADD_FAILURE() << "no triangle there";
    return 0.0;
}

TEST(ModelLayers, SmallThingsCastShadowsOnHugeFloors) {
    Model model = cube_on_floor();
    model.materials[0].metal = 0;
    const ModelLight light{uniform_environment(0.1f),
                           Sun{glm::normalize(glm::dvec3(1, 1, 0)), glm::dvec3(1.0)}};
    ModelLayersOptions options = quick();
    options.texels = 12'000;
    const ModelLayers layers = baked(model, light, options);
    const auto beside_cube = [&](double x, double z) {
        return light_above(layers, glm::dvec2(cube_place.x, cube_place.z) +
                                       static_cast<double>(cube_side) * glm::dvec2(x, z));
    };
    for (const auto& [x, z] :
         {std::pair(1.6, 0.0), {0.0, 0.8}, {0.0, -0.8}, {-1.9, 0.0}, {99.0, -99.0}})
        EXPECT_NEAR(beside_cube(x, z), beside_cube(2.0, 2.0), 0.1) << x << ", " << z;
    for (const auto& [x, z] : {std::pair(-0.8, 0.0), {-1.1, 0.0}, {-1.0, 0.2}, {-1.0, -0.2}})
        EXPECT_LT(beside_cube(x, z), 0.5 * beside_cube(2.0, 2.0)) << x << ", " << z;
}

TEST(ModelLayers, CanBeInterrupted) {
    ModelLayersOptions options = quick();
    options.run.cancelled = [] { return true; };
    const auto layers = bake_model_layers(cube_model(), white_light(), options);
    ASSERT_FALSE(layers.ok());
    EXPECT_EQ(layers.status().code(), ErrorCode::runtime);
}

TEST(ModelLayers, FewNoisyTexelsDoNotSetTheScale) {
    LightTexels light(2000, glm::vec3(0.5f));
    light[0] = glm::vec3(0.0f);
    light[7] = glm::vec3(50.0f);
    LayerTexture exact = make_layer(LayerRole::reflection, {2000, 1, 1, 1}, 3), robust = exact;
    store_light(exact, light, 64.0);
    EXPECT_EQ(exact.scale, 50.0);
    store_light(robust, light, 64.0, 1e-3);
    EXPECT_EQ(robust.scale, 0.5);
    EXPECT_EQ(robust.texels[0], std::byte{0});
    EXPECT_EQ(robust.texels[3], std::byte{255});
    EXPECT_EQ(robust.texels[21], std::byte{255});
    store_light(robust, LightTexels(2000, glm::vec3(0.0f)), 64.0, 1e-3);
    EXPECT_EQ(robust.scale, 1e-3);
}

} // namespace
} // namespace tessera::corpus
