// Tests the materials of glTF files, as the tracer sees them.
#include "corpus/model/opaque_alpha.h"
#include "tests/support/gltf_fixture.h"

namespace tessera::corpus {
namespace {

class GltfMaterials : public GltfFixture {};

TEST_F(GltfMaterials, IndexOfRefractionAndSpecular) {
    const auto lobes = [&](const std::string& extensions, double metal = 0.0) {
        const auto model = load(with_material(
            R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":)" +
            std::to_string(metal) + R"(},"extensions":{)" + extensions + "}}"));
        EXPECT_TRUE(model.ok()) << model.status().message();
        EXPECT_TRUE(model.ok() && model->notes.empty());
        return model.ok() ? middle_of(*model).lobes : Lobes();
    };
    const Lobes usual = lobes("");
    EXPECT_EQ(usual.facing, glm::dvec3(0.04));
    EXPECT_EQ(lobes(R"("KHR_materials_ior":{"ior":1.5})").facing.x, 0.04);
    const Lobes diamond = lobes(R"("KHR_materials_ior":{"ior":2.4})");
    EXPECT_NEAR(diamond.facing.x, std::pow(1.4 / 3.4, 2), 1e-12);
    EXPECT_NEAR(diamond.diffuse.x, 0.5 * (1 - diamond.facing.x) / 0.96, 1e-6);
    EXPECT_EQ(lobes(R"("KHR_materials_ior":{"ior":0})").facing.x, 1.0);
    const Lobes weak =
        lobes(R"("KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,2,0]})");
    EXPECT_NEAR(glm::distance(weak.facing, glm::dvec3(0.02, 0.04, 0)), 0, 1e-12);
    EXPECT_EQ(weak.grazing, 0.5);
    EXPECT_NEAR(fresnel(weak, 0.0).x, 0.5, 1e-12);
    const Lobes metal = lobes(R"("KHR_materials_specular":{"specularFactor":0})", 1.0);
    EXPECT_NEAR(glm::distance(metal.facing, glm::dvec3(0.5, 0.25, 1)), 0, 1e-6);
    EXPECT_EQ(metal.grazing, 1.0);
    EXPECT_EQ(metal.diffuse, glm::dvec3(0.0));
}

// Many files let materials blend whose alpha is 1.
TEST_F(GltfMaterials, AlphaThatRemovesNothingIsIgnored) {
    const auto read = [&](const std::string& mode, double alpha) {
        auto model =
            load(with_material(mode + R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,)" +
                               std::to_string(alpha) + "]}}"));
        EXPECT_TRUE(model.ok()) << model.status().message();
        return std::move(*model);
    };
    const std::string blend = R"({"alphaMode":"BLEND",)",
                      mask = R"({"alphaMode":"MASK","alphaCutoff":0.25,)";
    EXPECT_FALSE(material_of(read(blend, 1.0)).blends);
    EXPECT_TRUE(material_of(read(blend, 0.75)).blends);
    EXPECT_EQ(material_of(read(mask, 0.75)).cutoff, 0.0);
    EXPECT_EQ(material_of(read(mask, 0.125)).cutoff, 0.25);
    // Alpha of vertices and of pictures counts as well.
    Model model = read(blend, 0.75);
    ModelMaterial& used = model.materials[model.triangles[0].material];
    used.base.a = 1.0;
    model.images = {{2, 1, {{0, 0, 0, 255}, {0, 0, 0, 128}}}};
    used.base_texture.image = 0;
    ignore_opaque_alpha(model);
    EXPECT_TRUE(used.blends);
    model.images[0].texels[1][3] = 255;
    float& alpha = model.vertices[model.triangles[0].vertices[1]].colour.a;
    alpha = 0.5f;
    ignore_opaque_alpha(model);
    EXPECT_TRUE(used.blends);
    alpha = 1.0f;
    ignore_opaque_alpha(model);
    EXPECT_FALSE(used.blends);
}

// Factors and textures of all extensions that add to a material. All textures are one texel of red
// 1, green 0, blue 0.503 and alpha 0.2.
TEST_F(GltfMaterials, CoatsAreReadAndSampled) {
    const std::string texture = R"({"index":0})";
    const std::string more =
        R"("KHR_materials_clearcoat":{"clearcoatFactor":0.5,"clearcoatTexture":)" + texture +
        R"(,"clearcoatRoughnessFactor":0.6},"KHR_materials_sheen":{"sheenColorFactor":[0.2,0.4,0.8],)"
        R"("sheenColorTexture":)" +
        texture + R"(,"sheenRoughnessFactor":1,"sheenRoughnessTexture":)" + texture +
        R"(},"KHR_materials_anisotropy":{"anisotropyStrength":0.5,"anisotropyRotation":1.5707963},)"
        R"("KHR_materials_iridescence":{"iridescenceFactor":0.8,"iridescenceTexture":)" +
        texture +
        R"(,"iridescenceIor":1.7,"iridescenceThicknessMinimum":200,"iridescenceThicknessMaximum":500,)"
        R"("iridescenceThicknessTexture":)" +
        texture +
        R"(},"KHR_materials_transmission":{"transmissionFactor":0.4,"transmissionTexture":)" +
        texture +
        R"(},"KHR_materials_volume":{"thicknessFactor":0.1,"attenuationColor":[0.5,1,0.25],)"
        R"("attenuationDistance":0.2},"KHR_materials_ior":{"ior":1.7})";
    GltfText text = textured(R"({"uri":"none.png"})");
    text.more.replace(
        text.more.find(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})"),
        std::string(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})").size(),
        R"({"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.5,)"
        R"("baseColorFactor":[0.5,0.25,1,1]},"extensions":{)" +
            more + "}}");
    file("none.png", one_texel_png);
    auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty()) << model->notes[0];
    model->images[0] = {1, 1, {{255, 0, 188, 51}}};
    for (ModelVertex& v : model->vertices)
        v.tangent = {1, 0, 0, 1};
    const LitPoint point = middle_of(*model);
    ASSERT_TRUE(point.lobes.has_coats);
    const Coats& coats = point.lobes.coats;
    EXPECT_NEAR(coats.clear, 0.5, 1e-9);
    EXPECT_NEAR(coats.clear_alpha, 0.36, 1e-9);
    EXPECT_NEAR(glm::distance(coats.clear_normal, point.normal), 0, 1e-6);
    EXPECT_NEAR(glm::distance(coats.sheen, glm::dvec3(0.2, 0, 0.8 * 0.503)), 0, 1e-3);
    EXPECT_NEAR(coats.sheen_alpha, 0.04, 1e-9);
    EXPECT_NEAR(glm::distance(coats.along, glm::dvec3(0, 1, 0)), 0, 1e-6); // turned from x
    EXPECT_NEAR(coats.along_alpha, 0.25 + 0.75 * 0.25, 1e-9);
    EXPECT_NEAR(coats.film, 0.8, 1e-9);
    EXPECT_EQ(coats.film_ior, 1.7);
    EXPECT_NEAR(coats.film_nanometres, 200, 1e-9); // green is 0
    EXPECT_NEAR(glm::distance(coats.through, 0.4 * glm::dvec3(0.5, 0.25, 1)), 0, 1e-6);
    EXPECT_TRUE(coats.is_volume);
    EXPECT_EQ(coats.ior, 1.7);
    // The distance grows with the model, whose radius becomes 3.5.
    const double distance = 0.2 * 3.5 / std::sqrt(0.5);
    EXPECT_NEAR(std::exp(-coats.absorption.x * distance), 0.5, 1e-5);
    EXPECT_NEAR(std::exp(-coats.absorption.z * distance), 0.25, 1e-5);
}

TEST_F(GltfMaterials, SpecularTexturesAreSampled) {
    Model model = cube_model();
    model.images.push_back({1, 1, {{255, 0, 188, 51}}});
    model.materials[0].metal = 0;
    model.materials[0].specular_texture.image = 0;
    model.materials[0].specular_colour_texture.image = 0;
    const Lobes lobes = middle_of(model).lobes;
    EXPECT_NEAR(lobes.grazing, 0.2, 1e-9);
    EXPECT_NEAR(glm::distance(lobes.facing, 0.04 * 0.2 * glm::dvec3(1, 0, 0.503)), 0, 1e-4);
}

TEST_F(GltfMaterials, SpecularAndGlossiness) {
    const auto model = load(with_material(
        R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.5,0.25,1,0.75],)"
        R"("specularFactor":[0.2,0.1,0],"glossinessFactor":0.6}}})"));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    EXPECT_EQ(material_of(*model).base.a, 0.75);
    const Lobes lobes = middle_of(*model).lobes;
    EXPECT_NEAR(glm::distance(lobes.facing, glm::dvec3(0.2, 0.1, 0)), 0, 1e-12);
    EXPECT_NEAR(glm::distance(lobes.diffuse, glm::dvec3(0.5, 0.25, 1) * (0.8 / 0.96)), 0, 1e-6);
    EXPECT_NEAR(lobes.alpha, 0.16, 1e-9);
    Model textured = *model;
    textured.images.push_back({1, 1, {{255, 0, 188, 51}}});
    textured.materials[textured.triangles[0].material].metal_roughness_texture.image = 0;
    const Lobes sampled = middle_of(textured).lobes;
    EXPECT_NEAR(glm::distance(sampled.facing, glm::dvec3(0.2, 0, 0)), 0, 1e-4);
    EXPECT_NEAR(sampled.alpha, std::pow(1 - 0.6 * 0.2, 2), 1e-9);
}

TEST_F(GltfMaterials, UnlitMaterialsEmitTheirColour) {
    const auto model =
        load(with_material(R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1]},)"
                           R"("extensions":{"KHR_materials_unlit":{}}})"));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    Model bright = *model;
    bright.materials[bright.triangles[0].material].unlit_light = 3.0;
    const LitPoint point = middle_of(bright);
    EXPECT_NEAR(glm::distance(point.emission, glm::dvec3(1.5, 0.75, 3)), 0, 1e-6);
    EXPECT_EQ(point.lobes.diffuse, glm::dvec3(0.0));
    EXPECT_EQ(fresnel(point.lobes, 0.0), glm::dvec3(0.0));
    const auto rays = RayModel::make(bright);
    ASSERT_TRUE(rays.ok());
    EXPECT_NEAR((*rays)->emission({0, {0.2, 0.2}}).x, 1.5, 1e-6);
    EXPECT_TRUE(Emitters(*rays).empty());
}

} // namespace
} // namespace tessera::corpus
