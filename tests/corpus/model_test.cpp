// Tests reading of model files, both valid and hostile ones.
#include "corpus/trace/environment.h"
#include "tests/support/model_files.h"

#include <bit>

namespace tessera::corpus {
namespace {

using namespace support;

class Models : public testing::Test {
protected:
    std::string file(const std::string& name, const std::string& text) const {
        return write_text((folder_ / name).string(), text);
    }
    Result<Model> load(const std::string& name, const std::string& text) const {
        return load_model(file(name, text));
    }
    // Expects that the file is refused with this code and a message that contains its name and
    // `words`.
    void refuse(const std::string& name, const std::string& text, ErrorCode code,
                const std::string& words) const {
        const auto model = load(name, text);
        ASSERT_FALSE(model.ok()) << words;
        EXPECT_EQ(model.status().code(), code) << model.status().message();
        EXPECT_NE(model.status().message().find(words), std::string::npos)
            << model.status().message();
        EXPECT_NE(model.status().message().find(name), std::string::npos)
            << model.status().message();
    }

    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path folder_ = test::make_test_folder("models");
};

TEST_F(Models, TriangleOfGltfFillsThePapersSphere) {
    const auto model = load("a.gltf", GltfText().text());
    ASSERT_TRUE(model.ok()) << model.status().message();
    ASSERT_EQ(model->triangles.size(), 1u);
    double farthest = 0;
    for (const ModelVertex& v : model->vertices) {
        farthest = std::max(farthest, static_cast<double>(glm::length(v.position)));
        EXPECT_NEAR(v.normal.z, 1.0, 1e-6);
    }
    EXPECT_NEAR(farthest, 3.5, 1e-5);
}

TEST_F(Models, NodesTurnAndMirror) {
    GltfText text;
    text.nodes =
        R"({"children":[1],"rotation":[0,0,0.70710678,0.70710678]},{"mesh":0,"scale":[-1,1,1]})";
    const auto model = load("a.gltf", text.text());
    ASSERT_TRUE(model.ok()) << model.status().message();
    // Mirrored triangles are reversed, and keep their normals.
    const auto& t = model->triangles[0].vertices;
    const glm::vec3 a = model->vertices[t[0]].position, b = model->vertices[t[1]].position,
                    c = model->vertices[t[2]].position;
    EXPECT_GT(glm::cross(b - a, c - a).z, 0.0f);
    EXPECT_NEAR(model->vertices[t[0]].normal.z, 1.0, 1e-6);
}

TEST_F(Models, MaterialsOfGltf) {
    GltfText text;
    text.primitive = R"(,"material":0)";
    text.more =
        R"(,"materials":[{"doubleSided":true,"alphaMode":"MASK","emissiveFactor":[0,1,0],)"
        R"("pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":0.5,"roughnessFactor":0.75}}])";
    const auto model = load("a.gltf", text.text());
    ASSERT_TRUE(model.ok()) << model.status().message();
    const ModelMaterial& m = model->materials[model->triangles[0].material];
    EXPECT_EQ(m.base, glm::dvec4(0.5, 0.25, 1, 1));
    EXPECT_EQ(m.metal, 0.5);
    EXPECT_EQ(m.roughness, 0.75);
    EXPECT_EQ(m.emission, glm::dvec3(0, 1, 0));
    EXPECT_EQ(m.cutoff, 0.5);
    EXPECT_TRUE(m.double_sided);
}

TEST_F(Models, HostileGltfIsRefused) {
    GltfText nan;
    nan.positions[4] = std::numeric_limits<float>::quiet_NaN();
    refuse("nan.gltf", nan.text(), ErrorCode::invalid_file, "mesh 0, primitive 0: position 1");
    GltfText range;
    range.indices[2] = 3;
    refuse("range.gltf", range.text(), ErrorCode::invalid_file, "triangle 0 has vertex 3 of 3");
    GltfText flat;
    flat.indices = {0, 0, 1, 1, 1, 1};
    refuse("flat.gltf", flat.text(), ErrorCode::invalid_file, "none of which has an area");
    GltfText none;
    none.nodes = "{}";
    refuse("none.gltf", none.text(), ErrorCode::invalid_file, "has no triangles");
    GltfText cycle;
    cycle.nodes = R"({"children":[1]},{"children":[0]})";
    refuse("cycle.gltf", cycle.text(), ErrorCode::invalid_file, "below itself");
    GltfText texture;
    texture.primitive = R"(,"material":0)";
    texture.more = R"(,"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],)"
                   R"("textures":[{"source":0}],"images":[{"uri":"nowhere.png"}])";
    refuse("texture.gltf", texture.text(), ErrorCode::io, "image 0 (nowhere.png) is missing");
    GltfText extension;
    extension.more = R"(,"extensionsRequired":["EXT_meshopt_compression"])";
    refuse("ext.gltf", extension.text(), ErrorCode::unsupported, "EXT_meshopt_compression");
    GltfText draco;
    draco.primitive =
        R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}})";
    refuse("draco.gltf", draco.text(), ErrorCode::invalid_file, "Draco stream is damaged");
}

TEST_F(Models, HostileNumbersOfGltfAreRefused) {
    const std::string sound = GltfText().text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = sound;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos);
        return text.replace(at, from.size(), to);
    };
    refuse("a.gltf", with(R"("count":3)", R"("count":4)"), ErrorCode::invalid_file, "accessor 0");
    refuse("b.gltf", with(R"("buffer":0)", R"("buffer":7)"), ErrorCode::invalid_file,
           "bufferView 0 has no buffer");
    refuse("c.gltf", with(R"("byteLength":36})", R"("byteLength":37})"), ErrorCode::invalid_file,
           "bufferView 0 lies outside of its buffer");
    refuse("d.gltf", with(R"("uri":"data)", R"("uri":"nowhere.bin","x":"data)"),
           ErrorCode::invalid_file, "nowhere.bin");
    refuse("e.gltf", sound.substr(0, sound.size() / 2), ErrorCode::invalid_file, "is not JSON");
    refuse("f.gltf", with(R"("mesh":0)", R"("mesh":9)"), ErrorCode::invalid_file,
           "node 0 has mesh 9 of 1");
    refuse("g.gltf", std::string(100'000, '['), ErrorCode::invalid_file, "JSON");
    refuse("h.glb", std::string("glTF\2\0\0\0\100\0\0\0\377\377\377\177JSON", 20),
           ErrorCode::invalid_file, "chunk 0");
}

TEST_F(Models, EveryCutOfAGltfIsRefusedOrRead) {
    const std::string sound = GltfText().text();
    for (std::size_t size = 0; size < sound.size(); size += 7)
        EXPECT_FALSE(load("cut.gltf", sound.substr(0, size)).ok()) << size;
}

TEST_F(Models, ObjAndPly) {
    const auto obj = load("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    ASSERT_TRUE(obj.ok()) << obj.status().message();
    EXPECT_EQ(obj->triangles.size(), 2u);
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                             "property float y\nproperty float z\nelement face 1\n"
                             "property list uchar int vertex_indices\nend_header\n";
    const auto ply = load("a.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    ASSERT_TRUE(ply.ok()) << ply.status().message();
    EXPECT_EQ(ply->triangles.size(), 1u);
    EXPECT_FALSE(load("cut.ply", head.substr(0, head.size() - 12)).ok()); // for ever, once
    EXPECT_FALSE(
        load("none.ply", head + "0 0 0\n1 0 0\n0 1 0\n0\n").ok()); // ended the process, once
    EXPECT_FALSE(load("b.ply", head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n").ok());
    EXPECT_FALSE(load("b.obj", "v 0 0 0\n").ok());
    EXPECT_FALSE(load("c.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").ok());
}

// Memory is reserved by Assimp for whatever a PLY claims: the first two took 103 and 27 GB.
TEST_F(Models, PlyThatClaimsMoreThanItHas) {
    const auto with = [&](std::string_view old, std::string_view now) {
        std::string text =
            "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement vertex 3\r\n"
            "property float x\r\nproperty float y\r\nproperty float z\r\nelement face 1\r\n"
            "property list uchar int vertex_indices\r\nend_header\r\n"
            "0 0 0\r\n1e0 0 +0\r\n0 1.0 0\r\n3 0 1 2\r\n";
        text.replace(text.find(old), old.size(), now);
        return load("a.PLY", text).status();
    };
    EXPECT_TRUE(with("ply", "ply").ok()) << with("ply", "ply").message();
    const auto refuses = [&](std::string_view old, std::string_view now, const char* what) {
        EXPECT_EQ(with(old, now).code(), ErrorCode::invalid_file) << now;
        EXPECT_NE(with(old, now).message().find(what), std::string::npos)
            << with(old, now).message();
    };
    refuses("vertex 3", "4294967295vertex 3", "line 4");
    refuses("3 0 1 2", "11111111111111111111 0 1 2", "element face: line 14");
    refuses("3 0 1 2", "3 0 1", "line 14");
    refuses("3 0 1 2", "3 0 1 2 4294967295", "line 14");
    refuses("face 1", "face 4294967295", "line 8");
    refuses("face 1", "face 2", "element face");
    refuses("float x", "float x y", "line 5");
    refuses("float z", "floot z", "line 7");
    refuses("end_header", "end", "line 10");
}

TEST_F(Models, BinaryPly) {
    const auto file_of = [](bool big, int corners, std::size_t keep) {
        std::string text = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                           "_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                           "property float z\nelement face 1\n"
                           "property list int int vertex_indices\nend_header\n";
        const auto put = [&](std::uint32_t x) {
            for (int i = 0; i < 4; ++i)
                text.push_back(static_cast<char>(x >> 8 * (big ? 3 - i : i)));
        };
        for (const float x : {0, 0, 0, 1, 0, 0, 0, 1, 0})
            put(std::bit_cast<std::uint32_t>(x));
        put(static_cast<std::uint32_t>(corners));
        for (std::uint32_t i = 0; i < 3; ++i)
            put(i);
        return text.substr(0, text.size() - 52 + keep);
    };
    for (const bool big : {false, true}) {
        const auto sound = load("a.ply", file_of(big, 3, 52));
        ASSERT_TRUE(sound.ok()) << sound.status().message();
        EXPECT_EQ(sound->triangles.size(), 1u);
        for (const int corners : {-3, 4, 0x7FFFFFFF})
            EXPECT_EQ(load("a.ply", file_of(big, corners, 52)).status().code(),
                      ErrorCode::invalid_file);
        for (const std::size_t keep : {0, 35, 36, 39, 40, 51})
            EXPECT_EQ(load("a.ply", file_of(big, 3, keep)).status().code(),
                      ErrorCode::invalid_file);
    }
}

TEST_F(Models, UnknownKindsAndMissingFiles) {
    EXPECT_EQ(load("a.stl", "").status().code(), ErrorCode::bad_argument);
    for (const char* name : {"no.gltf", "no.obj", "no.ply"}) {
        const auto model = load_model((folder_ / name).string());
        ASSERT_FALSE(model.ok());
        EXPECT_EQ(model.status().code(), ErrorCode::io) << model.status().message();
        EXPECT_NE(model.status().message().find(name), std::string::npos);
    }
}

TEST_F(Models, EnvironmentsThatAreNone) {
    EXPECT_EQ(Environment::load((folder_ / "no.exr").string()).status().code(), ErrorCode::io);
    const auto damaged = Environment::load(file("a.hdr", "#?RADIANCE\nnonsense"));
    EXPECT_EQ(damaged.status().code(), ErrorCode::invalid_file) << damaged.status().message();
    const auto exr = Environment::load(file("a.exr", std::string("\x76\x2f\x31\x01zzzz", 8)));
    EXPECT_EQ(exr.status().code(), ErrorCode::invalid_file) << exr.status().message();
}

} // namespace
} // namespace tessera::corpus
