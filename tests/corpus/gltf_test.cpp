// Tests what glTF files of other programs have: features that are read, and those that are noted.
#include "corpus/trace/ray_model.h"
#include "tests/support/model_files.h"

#include <algorithm>
#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

class Gltf : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& bytes) const {
        return write_text((folder_ / name).string(), bytes);
    }
    Result<Model> load(const GltfText& text) const {
        return load_model(file("a.gltf", text.text()));
    }
    // Expects that the model is read with exactly one note, which contains `words`.
    Model load_with_note(const GltfText& text, const std::string& words) const {
        auto model = load(text);
        EXPECT_TRUE(model.ok()) << model.status().message();
        if (!model.ok())
            return {};
        EXPECT_EQ(model->notes.size(), 1u) << words;
        if (!model->notes.empty())
            EXPECT_NE(model->notes[0].find(words), std::string::npos) << model->notes[0];
        return std::move(*model);
    }
    void refuse(const GltfText& text, const std::string& words) const {
        const auto model = load(text);
        ASSERT_FALSE(model.ok()) << words;
        EXPECT_EQ(model.status().code(), ErrorCode::invalid_file);
        EXPECT_NE(model.status().message().find(words), std::string::npos)
            << model.status().message();
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_ = test::make_test_folder("gltf");
};

// A triangle with a base colour texture; `images` is the list of the file's images.
GltfText textured(const std::string& images, const std::string& texture = R"("source":0)",
                  const std::string& use = "") {
    GltfText text;
    text.primitive = R"(,"material":0)";
    text.more = R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0)" + use +
                R"(}}}],"textures":[{)" + texture + R"(}],"images":[)" + images + "]";
    return text;
}

const ModelMaterial& material_of(const Model& model) {
    return model.materials[model.triangles[0].material];
}

TEST_F(Gltf, MeshesOfScaleZeroAreSkipped) {
    GltfText text;
    text.nodes = R"({"mesh":0,"children":[1]},{"mesh":0,"scale":[0,0,0]})";
    EXPECT_EQ(load_with_note(text, "1 mesh with a scale of 0").triangles.size(), 1u);
}

TEST_F(Gltf, SparseAccessorsReplaceElements) {
    GltfText text;
    // Buffer 2 moves vertex 2 to (0, 2, 0).
    text.buffers = R"(,{"byteLength":16,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(std::vector<std::uint32_t>{2, 0, 0x40000000, 0}) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":4},{"buffer":2,"byteOffset":4,"byteLength":12})";
    text.position = R"(,"sparse":{"count":1,"indices":{"bufferView":2,"componentType":5125},)"
                    R"("values":{"bufferView":3}})";
    const auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    const auto edge = [&](std::uint32_t a, std::uint32_t b) {
        return glm::distance(model->vertices[a].position, model->vertices[b].position);
    };
    EXPECT_NEAR(edge(0, 2) / edge(0, 1), 2.0, 1e-5);

    GltfText beyond = text;
    beyond.buffers = R"(,{"byteLength":16,"uri":"data:application/octet-stream;base64,)" +
                     base64_of(std::vector<std::uint32_t>{3, 0, 0x40000000, 0}) + R"("})";
    refuse(beyond, "replaces an element that it does not have");
    GltfText many = text;
    many.position.replace(many.position.find(R"("count":1)"), 9, R"("count":4)");
    refuse(many, "replaces more elements than it has");
    GltfText short_view = text;
    short_view.views =
        R"(,{"buffer":2,"byteLength":2},{"buffer":2,"byteOffset":4,"byteLength":12})";
    refuse(short_view, "reaches beyond its bufferView");
}

TEST_F(Gltf, AccessorsWithoutBytesAreZero) {
    GltfText text;
    text.primitive = ""; // positions at the origin have no area
    text.position_view = "";
    refuse(text, "none of which has an area");
}

TEST_F(Gltf, TextureTransforms) {
    file("a.png", one_texel_png);
    const auto model = load(
        textured(R"({"uri":"a.png"})", R"("source":0)",
                 R"(,"extensions":{"KHR_texture_transform":{"offset":[0.5,0.25],"scale":[2,3],)"
                 R"("rotation":1.5707963267948966,"texCoord":1}})"));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    const TextureUse& use = material_of(*model).base_texture;
    EXPECT_EQ(use.uv, 1u);
    // u turns to where v is smaller, which is up.
    const glm::dvec2 u = use.turn * glm::dvec2(1, 0), v = use.turn * glm::dvec2(0, 1);
    EXPECT_NEAR(glm::distance(u, {0, -2}), 0, 1e-12);
    EXPECT_NEAR(glm::distance(v, {3, 0}), 0, 1e-12);
    EXPECT_EQ(use.offset, glm::dvec2(0.5, 0.25));
    refuse(textured(R"({"uri":"a.png"})", R"("source":0)",
                    R"(,"extensions":{"KHR_texture_transform":{"scale":[1e300,1]}})"),
           "KHR_texture_transform");
}

// The texture is sampled at the transformed place.
TEST_F(Gltf, TransformedTexturesAreSampled) {
    Model model = cube_model();
    model.images.push_back({2, 1, {{255, 0, 0, 255}, {0, 255, 0, 255}}});
    model.materials[0].base_texture.image = 0;
    const auto colour = [&](const glm::dvec2& offset) {
        model.materials[0].base_texture.offset = offset;
        model.materials[0].metal = 0;
        const auto traced = RayModel::make(model);
        EXPECT_TRUE(traced.ok());
        return (*traced)->point({0, {0.3, 0.3}}).lobes.diffuse;
    };
    EXPECT_GT(colour({0.25, 0.5}).x, 0.9); // all uv are 0
    EXPECT_GT(colour({0.75, 0.5}).y, 0.9);
}

TEST_F(Gltf, ImagesThatCannotBeReadAreNoted) {
    file("a.png", one_texel_png);
    file("bad.png", "no picture");
    EXPECT_EQ(material_of(load_with_note(textured(R"({"uri":"nowhere.png"})"),
                                         "image 0 (nowhere.png) is missing"))
                  .base_texture.image,
              -1);
    load_with_note(textured(R"({"uri":"bad.png"})"), "image 0 (bad.png)");
    load_with_note(textured("", R"("extensions":{})"), "texture 0 has no image");
    // Nothing uses the second image.
    const auto unused = load(textured(R"({"uri":"a.png"},{"uri":"nowhere.png"})"));
    ASSERT_TRUE(unused.ok()) << unused.status().message();
    EXPECT_TRUE(unused->notes.empty());
    EXPECT_EQ(unused->images[0].width, 1u);
}

TEST_F(Gltf, WebPComesBeforeItsFallback) {
    file("a.png", one_texel_png);
    const auto model =
        load(textured(R"({"uri":"nowhere.png"},{"uri":"a.png"})",
                      R"("source":0,"extensions":{"EXT_texture_webp":{"source":1}})"));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    EXPECT_EQ(material_of(*model).base_texture.image, 1);
}

TEST_F(Gltf, NamesAndKindsOfUris) {
    const std::string data =
        base64_of(std::vector<char>(one_texel_png.begin(), one_texel_png.end()));
    file("a+b.png", one_texel_png);
    file("c d.png", one_texel_png);
    for (const std::string& uri :
         {std::string("a+b.png"), std::string("a%2Bb.png"), std::string("c%20d.png"),
          std::string("c d.png"), "data:image/x-unknown;charset=utf-8;base64," + data,
          "DATA:image/PNG;Base64," + data}) {
        const auto model = load(textured(R"({"uri":")" + uri + R"("})"));
        ASSERT_TRUE(model.ok()) << model.status().message();
        EXPECT_TRUE(model->notes.empty()) << uri.substr(0, 40);
    }
}

TEST_F(Gltf, WhatIsIgnoredIsNamedAndCounted) {
    GltfText text;
    text.primitive = R"(,"material":0,"targets":[{"POSITION":0}])";
    text.more =
        R"(,"materials":[{"alphaMode":"BLEND","extensions":{"KHR_materials_clearcoat":{}}},)"
        R"({"extensions":{"KHR_materials_clearcoat":{}}}])"
        R"(,"animations":[{"channels":[],"samplers":[]}],"skins":[{"joints":[0]}])";
    const auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    for (const char* words : {"alphaMode BLEND (1 material)", "KHR_materials_clearcoat (2 uses)",
                              "1 animation", "1 skin", "1 primitive has morph targets"})
        EXPECT_TRUE(std::ranges::any_of(model->notes, [&](const std::string& note) {
            return note.find(words) != std::string::npos;
        })) << words;
    EXPECT_EQ(model->notes.size(), 5u);
}

TEST_F(Gltf, InstancesOfAMesh) {
    GltfText text;
    text.buffers = R"(,{"byteLength":24,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(std::vector<float>{0, 0, 0, 0, 0, 5}) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":24})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":2})";
    text.nodes = R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":)"
                 R"({"attributes":{"TRANSLATION":2}}}})";
    const auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    ASSERT_EQ(model->triangles.size(), 2u);
    const glm::vec3 way = model->vertices[model->triangles[1].vertices[0]].position -
                          model->vertices[model->triangles[0].vertices[0]].position;
    EXPECT_GT(way.z, 1.0f);
    EXPECT_NEAR(way.x, 0.0f, 1e-5f);

    text.nodes = R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":)"
                 R"({"attributes":{"TRANSLATION":2,"SCALE":0}}}})";
    refuse(text, "attributes of different lengths");
}

TEST_F(Gltf, ColoursThatAreNoNumbersBecomeWhite) {
    GltfText text;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    text.buffers = R"(,{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(std::vector<float>{1, 0, 0, nan, 0, 0, 0, 1, 0}) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":36})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":3})";
    text.attributes = R"(,"COLOR_0":2)";
    const Model model = load_with_note(text, "1 of 3 colours");
    ASSERT_EQ(model.triangles.size(), 1u);
    EXPECT_EQ(model.vertices[model.triangles[0].vertices[0]].colour, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(model.vertices[model.triangles[0].vertices[1]].colour, glm::vec4(1));
}

} // namespace
} // namespace tessera::corpus
