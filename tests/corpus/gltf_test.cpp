// Tests what glTF files of other programs have: features that are read, and those that are noted.
#include "tests/support/gltf_fixture.h"

#include <algorithm>
#include <meshoptimizer.h>
#include <numbers>

namespace tessera::corpus {
namespace {

using namespace support;

class Gltf : public GltfFixture {};

TEST_F(Gltf, MeshesOfScaleZeroAreSkipped) {
    GltfText text;
    text.nodes = R"({"mesh":0,"children":[1]},{"mesh":0,"scale":[0,0,0]})";
    EXPECT_EQ(load_with_note(text, "1 mesh with a scale of 0").triangles.size(), 1u);
}

// Exporters also hide with a tiny scale, whose determinant is almost 0.
TEST_F(Gltf, MeshesOfTinyScaleAreSkipped) {
    GltfText text;
    text.nodes = R"({"mesh":0,"children":[1]},{"mesh":0,"scale":[1e-12,1e-12,1e-12]})";
    EXPECT_EQ(load_with_note(text, "1 mesh with a scale of 0").triangles.size(), 1u);
}

TEST_F(Gltf, NodesWithoutASceneAreRead) {
    GltfText text;
    text.nodes = R"({"children":[1]},{"mesh":0},{"mesh":0})";
    std::string json = text.text();
    const std::string scenes = R"("scene":0,"scenes":[{"nodes":[0]}],)";
    json.erase(json.find(scenes), scenes.size());
    const auto model = load_model(file("a.gltf", json));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_EQ(model->triangles.size(), 2u);
}

TEST_F(Gltf, FilesWithoutTrianglesSayWhatTheyAre) {
    GltfText points;
    points.primitive = R"(,"mode":0)";
    EXPECT_NE(load(points).status().message().find("only points and lines"), std::string::npos);
    const auto old = load_model(file("old.gltf", R"({"meshes":{},"nodes":{}})"));
    EXPECT_NE(old.status().message().find("is glTF 1.0"), std::string::npos);
}

// Whatever is not a number leaves the rest of the model as it is.
TEST_F(Gltf, NumbersThatAreNoneAreLeftOut) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    GltfText text;
    text.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0};
    text.indices = {0, 1, 2, 0, 1, 3};
    EXPECT_EQ(load_with_note(text, "1 of 4 positions are not numbers").triangles.size(), 1u);
    GltfText normals;
    normals.buffers = R"(,{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                      base64_of(std::vector<float>{nan, 0, 0, 0, 0, 1, 0, 0, 1}) + R"("})";
    normals.views = R"(,{"buffer":2,"byteLength":36})";
    normals.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":3})";
    normals.attributes = R"(,"NORMAL":2)";
    const Model model = load_with_note(normals, "1 of 3 normals are not numbers");
    for (const ModelVertex& v : model.vertices)
        EXPECT_EQ(v.normal, glm::vec3(0, 0, 1));
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

// Vertices have two sets of texture coordinates, which may be any of the file's.
TEST_F(Gltf, HighSetsOfTextureCoordinates) {
    file("a.png", one_texel_png);
    GltfText text = textured(R"({"uri":"a.png"})", R"("source":0)", R"(,"texCoord":3)");
    text.buffers = R"(,{"byteLength":24,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(std::vector<float>{0, 0, 0.5f, 0, 0, 0.25f}) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":24})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC2","count":3})";
    text.attributes = R"(,"TEXCOORD_3":2)";
    const auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    const unsigned set = material_of(*model).base_texture.uv;
    EXPECT_EQ(model->vertices[model->triangles[0].vertices[1]].uv[set], glm::vec2(0.5f, 0.0f));
    GltfText three = text;
    three.more.replace(three.more.find(R"("materials":[{)"), 14,
                       R"("materials":[{"normalTexture":{"index":0,"texCoord":2},)"
                       R"("emissiveTexture":{"index":0,"texCoord":5},)");
    EXPECT_EQ(material_of(load_with_note(three, "its picture in TEXCOORD_5 is left out"))
                  .emission_texture.image,
              -1);
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
    const Model unused = load_with_note(textured(R"({"uri":"a.png"},{"uri":"nowhere.png"})"),
                                        "image 1 (nowhere.png) is missing, and nothing uses it");
    EXPECT_EQ(unused.images[0].width, 1u);
}

TEST_F(Gltf, WebPComesBeforeItsFallback) {
    file("a.png", one_texel_png);
    const Model model =
        load_with_note(textured(R"({"uri":"nowhere.png"},{"uri":"a.png"})",
                                R"("source":0,"extensions":{"EXT_texture_webp":{"source":1}})"),
                       "image 0 (nowhere.png) is missing, and nothing uses it");
    EXPECT_EQ(material_of(model).base_texture.image, 1);
}

// KTX2 is not read: the fallback of its texture, or a picture of its name beside it.
TEST_F(Gltf, Ktx2HasPicturesBesideIt) {
    const std::string ktx2 = "\xabKTX 20\xbb\r\n\x1a\n and what follows";
    file("a.png", one_texel_png);
    file("b c.ktx2", ktx2);
    const std::string images = R"({"uri":"b%20c.ktx2"},{"uri":"a.png"})",
                      extension = R"("extensions":{"KHR_texture_basisu":{"source":0}})";
    const Model fallback = load_with_note(textured(images, R"("source":1,)" + extension),
                                          "KTX2 is not read: 1 texture has its fallback picture");
    EXPECT_EQ(material_of(fallback).base_texture.image, 1);
    GltfText required = textured(images, extension);
    required.more += R"(,"extensionsRequired":["KHR_texture_basisu"])";
    EXPECT_EQ(material_of(load_with_note(required, "image 0 (b%20c.ktx2) is KTX2, which is not "
                                                   "read; put a PNG of the same name beside it"))
                  .base_texture.image,
              -1);
    file("b c.png", one_texel_png);
    const Model beside = load_with_note(required, "b c.png beside it is taken");
    EXPECT_EQ(material_of(beside).base_texture.image, 0);
    EXPECT_EQ(beside.images[0].width, 1u);
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
    text.primitive = R"(,"material":0)";
    text.more =
        R"(,"materials":[{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5]},)"
        R"("extensions":{"KHR_materials_dispersion":{}}},)"
        R"({"extensions":{"KHR_materials_dispersion":{}}}])"
        R"(,"animations":[{"channels":[],"samplers":[]}])";
    const auto model = load(text);
    ASSERT_TRUE(model.ok()) << model.status().message();
    for (const char* words : {"KHR_materials_dispersion (2 uses)", "1 animation"})
        EXPECT_TRUE(std::ranges::any_of(model->notes, [&](const std::string& note) {
            return note.find(words) != std::string::npos;
        })) << words;
    EXPECT_EQ(model->notes.size(), 2u);
    EXPECT_TRUE(model->materials[1].blends);
    EXPECT_FALSE(model->materials[2].blends);
}

// Lamps move and grow with the model, whose radius becomes 3.5.
TEST_F(Gltf, LightsArePlacedAndScaled) {
    GltfText text;
    text.nodes = R"({"mesh":0,"children":[1,2,3,4]},)"
                 R"({"translation":[0.5,0.5,2],"extensions":{"KHR_lights_punctual":{"light":0}}},)"
                 R"({"rotation":[0.7071067811865476,0,0,0.7071067811865476],)"
                 R"("extensions":{"KHR_lights_punctual":{"light":1}}},)"
                 R"({"extensions":{"KHR_lights_punctual":{"light":2}}},)"
                 R"({"extensions":{"KHR_lights_punctual":{"light":3}}})";
    text.more =
        R"(,"extensionsRequired":["KHR_lights_punctual"],"extensionsUsed":["KHR_lights_punctual"],)"
        R"("extensions":{"KHR_lights_punctual":{"lights":[)"
        R"({"type":"point","color":[1,0.5,0],"intensity":8,"range":10},)"
        R"({"type":"directional","intensity":3},)"
        R"({"type":"spot","spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}},)"
        R"({"type":"point","intensity":0}]}})";
    const Model model = load_with_note(text, "skipped 1 light without any intensity");
    ASSERT_EQ(model.lamps.size(), 3u);
    const double scale = 3.5 / std::sqrt(0.5);
    const ModelLamp& point = model.lamps[0];
    EXPECT_EQ(point.kind, ModelLamp::Kind::point);
    EXPECT_NEAR(glm::distance(point.position, {0, 0, 2 * scale}), 0, 1e-5);
    EXPECT_NEAR(glm::distance(point.strength, glm::dvec3(8, 4, 0) * scale * scale), 0, 1e-3);
    EXPECT_NEAR(point.range, 10 * scale, 1e-4);
    // On the triangle's middle arrives what the file states: 8 / 2^2.
    const LampLight light = lamp_light(point, {0, 0, 0});
    EXPECT_NEAR(light.irradiance.x, 2 * (1 - std::pow(0.2, 4)), 1e-5);
    EXPECT_NEAR(glm::distance(light.direction, {0, 0, 1}), 0, 1e-5);
    EXPECT_EQ(lamp_light(point, {0, 0, -100}).irradiance, glm::dvec3(0.0));
    const ModelLamp& sun = model.lamps[1];
    EXPECT_EQ(sun.kind, ModelLamp::Kind::directional);
    EXPECT_NEAR(glm::distance(sun.direction, {0, 1, 0}), 0, 1e-6); // turned from -z
    EXPECT_EQ(lamp_light(sun, {9, 9, 9}).irradiance, glm::dvec3(3.0));
    EXPECT_NEAR(glm::distance(lamp_light(sun, {9, 9, 9}).direction, {0, -1, 0}), 0, 1e-6);
    const ModelLamp& spot = model.lamps[2];
    const auto from_axis = [&](double angle) { // at a distance of 1 in the file's units
        const glm::dvec3 way{std::sin(angle), 0, -std::cos(angle)};
        return lamp_light(spot, spot.position + way * scale).irradiance.x;
    };
    EXPECT_NEAR(from_axis(0.1), 1, 1e-4);
    EXPECT_EQ(from_axis(0.51), 0);
    const double share = (std::cos(0.4) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
    EXPECT_NEAR(from_axis(0.4), share * share, 1e-4);
}

// Cameras move with the model, whose radius becomes 3.5, and have different names.
TEST_F(Gltf, CamerasAreNamedAndPlaced) {
    GltfText text;
    text.nodes = R"({"mesh":0,"children":[1,2,3,4]},)"
                 R"({"camera":0,"name":"front","translation":[0.5,0.5,2]},)"
                 R"({"camera":0,"name":"front","translation":[0.5,0.5,0],)"
                 R"("rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,2,2]},)"
                 R"({"camera":0},{"camera":1})";
    text.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}},)"
                R"({"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":0}}])";
    const Model model = load_with_note(text, "skipped 1 camera without a perspective");
    ASSERT_EQ(model.cameras.size(), 3u);
    const ModelCamera& front = model.cameras[0];
    EXPECT_EQ(front.name, "front");
    EXPECT_NEAR(glm::distance(front.eye, {0, 0, 2 * 3.5 / std::sqrt(0.5)}), 0, 1e-5);
    EXPECT_NEAR(glm::distance(front.forward, {0, 0, -1}), 0, 1e-9);
    EXPECT_NEAR(glm::distance(front.up, {0, 1, 0}), 0, 1e-9);
    EXPECT_NEAR(front.fov, 28.6478897565, 1e-9);
    EXPECT_EQ(model.cameras[1].name, "front (2)");
    EXPECT_NEAR(glm::distance(model.cameras[1].up, {-1, 0, 0}), 0, 1e-9); // turned about z
    EXPECT_EQ(model.cameras[2].name, "camera 2");
}

// A view that meshoptimizer compressed, beside a buffer that only stands in for its bytes.
TEST_F(Gltf, ViewsThatMeshoptimizerCompressed) {
    const std::vector<float> positions{0, 0, 0, 2, 0, 0, 0, 1, 0, 2, 1, 0};
    const std::vector<std::uint32_t> indices{0, 1, 2, 2, 1, 3};
    std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(4, 12)),
        triangles(meshopt_encodeIndexBufferBound(6, 4));
    vertices.resize(
        meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 4, 12));
    triangles.resize(
        meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(), 6));
    const auto text = [&](const std::string& mode, std::size_t cut = 0) {
        std::vector<unsigned char> bytes(vertices.begin(),
                                         vertices.end() - static_cast<std::ptrdiff_t>(cut));
        bytes.resize((bytes.size() + 3) / 4 * 4);
        const std::size_t second = bytes.size();
        bytes.insert(bytes.end(), triangles.begin(), triangles.end());
        const auto view = [](std::size_t offset, std::size_t length, const std::string& more) {
            return R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
                   std::to_string(length) + more + "}";
        };
        const auto extension = [&](std::size_t offset, std::size_t length,
                                   const std::string& more) {
            return R"(,"extensions":{"EXT_meshopt_compression":{"buffer":1,"byteOffset":)" +
                   std::to_string(offset) + R"(,"byteLength":)" + std::to_string(length) + more +
                   "}}";
        };
        return R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_meshopt_compression"],)"
               R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"buffers":[{"byteLength":72,)"
               R"("extensions":{"EXT_meshopt_compression":{"fallback":true}}},{"byteLength":)" +
               std::to_string(bytes.size()) + R"(,"uri":"data:application/octet-stream;base64,)" +
               base64_of(bytes) + R"("}],"bufferViews":[)" +
               view(0, 48,
                    extension(0, vertices.size() - cut,
                              R"(,"byteStride":12,"count":4,"mode":")" + mode + R"(")")) +
               "," +
               view(48, 24,
                    extension(second, triangles.size(),
                              R"(,"byteStride":4,"count":6,"mode":"TRIANGLES")")) +
               R"(],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
               R"({"bufferView":1,"componentType":5125,"type":"SCALAR","count":6}],)"
               R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]})";
    };
    const auto model = load_model(file("m.gltf", text("ATTRIBUTES")));
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    ASSERT_EQ(model->triangles.size(), 2u);
    const double scale = 3.5 / std::sqrt(1.25);
    EXPECT_NEAR(glm::distance(model->vertices[0].position, glm::vec3(-scale, -scale / 2, 0)), 0,
                1e-5);
    EXPECT_NEAR(glm::distance(model->vertices.back().position, glm::vec3(scale, scale / 2, 0)), 0,
                1e-5);
    for (const auto& [bad, words] :
         {std::pair(text("ATTRIBUTES", 5), "mode ATTRIBUTES: damaged"),
          std::pair(text("TRIANGLES"), "cannot have elements of 12 bytes"),
          std::pair(text("OTHER"), "cannot have elements of 12 bytes")}) {
        const auto refused = load_model(file("m.gltf", bad));
        EXPECT_EQ(refused.status().code(), ErrorCode::invalid_file) << words;
        EXPECT_NE(refused.status().message().find(words), std::string::npos)
            << refused.status().message();
    }
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
