// Tests reading of PLY files.
#include "tests/support/model_files.h"

#include <bit>
#include <cmath>

namespace tessera::corpus {
namespace {

using namespace support;

class PlyModels : public ModelFiles {};

// What a header or a list claims must not decide how much memory is reserved.
TEST_F(PlyModels, PlyThatClaimsMoreThanItHas) {
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
    // Lines of other words before the first element, as Blender 2.4 wrote them, are skipped.
    EXPECT_TRUE(with("comment made", "Created").ok());
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

TEST_F(PlyModels, BinaryPly) {
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

TEST_F(PlyModels, PropertiesOfPly) {
    const auto model =
        load("a.ply", "ply\ncomment before the format\nformat ascii 1.0\nelement vertex 4\n"
                      "property double x\nproperty float32 y\ncomment between\n"
                      "property int z\nproperty float nx\nproperty float ny\n"
                      "property float nz\nproperty uchar red\nproperty ushort green\n"
                      "property float blue\nproperty uchar alpha\nproperty float s\n"
                      "property float t\nproperty list uchar float more\n"
                      "element edge 1\nproperty int vertex1\nobj_info something\n"
                      "element face 1\nproperty list ushort uint8 vertex_index\n"
                      "property uchar flags\nend_header\n"
                      "0 0 0 0 0 2 255 0 0 255 0 0 0\n1 0 0 0 0 2 0 65535 0 0 1 0.25 2 7 8\n"
                      "\ncomment in the data\n1 1 0 0 0 2 0 0 1 255 1 1 0\n"
                      "0 1 0 0 0 0 255 65535 1 255 0 1 0\n7\n4 0 1 2 3 9\n");
    ASSERT_TRUE(model.ok()) << model.status().message();
    ASSERT_EQ(model->triangles.size(), 2u);
    const auto corner = [&](std::size_t triangle, std::size_t k) {
        return model->vertices[model->triangles[triangle].vertices[k]];
    };
    EXPECT_EQ(corner(0, 0).colour, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(corner(0, 1).colour, glm::vec4(0, 1, 0, 0));
    EXPECT_EQ(corner(0, 2).colour, glm::vec4(0, 0, 1, 1));
    EXPECT_EQ(corner(1, 2).colour, glm::vec4(1.0f));
    EXPECT_EQ(corner(0, 1).uv[0], glm::vec2(1.0f, 0.75f));
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(corner(1, k).normal, glm::vec3(0, 0, 1));
}

TEST_F(PlyModels, TexturesAndStripsOfPly) {
    file("one.png", one_texel_png);
    const std::string head = "ply\nformat ascii 1.0\ncomment TextureFile one.png\n"
                             "element vertex 5\nproperty float x\nproperty float y\n"
                             "property float z\n",
                      corners = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n";
    const auto faces =
        load("a.ply", head +
                          "element face 2\nproperty list uchar int vertex_indices\n"
                          "property list uchar float texcoord\nend_header\n" +
                          corners + "3 0 1 2 6 0 0 1 0 0 1\n3 2 1 3 6 0 0 1 0 1 1\n");
    ASSERT_TRUE(faces.ok()) << faces.status().message();
    ASSERT_EQ(faces->triangles.size(), 2u);
    EXPECT_EQ(faces->vertices[faces->triangles[0].vertices[2]].uv[0], glm::vec2(0, 0));
    EXPECT_EQ(faces->vertices[faces->triangles[1].vertices[0]].uv[0], glm::vec2(0, 1));
    EXPECT_EQ(faces->materials[0].base_texture.image, 0);

    const auto strips = load("b.ply", head +
                                          "element tristrips 1\n"
                                          "property list int int vertex_indices\nend_header\n" +
                                          corners + "9 0 1 2 3 4 -1 0 1 2\n");
    ASSERT_TRUE(strips.ok()) << strips.status().message();
    EXPECT_EQ(strips->triangles.size(), 4u);
    for (const ModelVertex& v : strips->vertices)
        EXPECT_EQ(v.normal, glm::vec3(0, 0, 1));
    refuse("c.ply", head + "end_header\n" + corners, ErrorCode::unsupported,
           "a point cloud, not a mesh");
}

TEST_F(PlyModels, FirstMaterialOfPly) {
    const auto model = load("a.ply", "ply\nformat ascii 1.0\nelement material 2\n"
                                     "property uchar diffuse_red\nproperty uchar diffuse_green\n"
                                     "property uchar diffuse_blue\nproperty float specular_power\n"
                                     "element face 1\nproperty list uchar int vertex_indices\n"
                                     "element vertex 3\nproperty float x\nproperty float y\n"
                                     "property float z\nend_header\n255 0 0 10\n0 255 0 20\n"
                                     "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n");
    ASSERT_TRUE(model.ok()) << model.status().message();
    const ModelMaterial& m = model->materials[model->triangles[0].material];
    EXPECT_EQ(m.base, glm::dvec4(1, 0, 0, 1));
    EXPECT_NEAR(m.roughness, std::pow(2.0 / 152.0, 0.25), 1e-9);
}

// Some tools name the colours of vertices as those of materials.
TEST_F(PlyModels, VertexColoursOfPly) {
    for (const std::string name : {"", "diffuse_"}) {
        const auto model = load(
            "a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                     "property float y\nproperty float z\nproperty uchar " +
                         name + "red\nproperty uchar " + name + "green\nproperty uchar " + name +
                         "blue\nelement face 1\nproperty list uchar int vertex_indices\n"
                         "end_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
        ASSERT_TRUE(model.ok()) << model.status().message();
        for (glm::length_t k = 0; k < 3; ++k) {
            glm::vec4 colour(0, 0, 0, 1);
            colour[k] = 1.0f;
            const auto corner = static_cast<std::size_t>(k);
            EXPECT_EQ(model->vertices[model->triangles[0].vertices[corner]].colour, colour) << name;
        }
    }
}

// A line feed is data where the header's lines end otherwise or the number begins with one.
TEST_F(PlyModels, BinaryPlyWhoseDataBeginsWithALineFeed) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
                           "property uchar x\nproperty uchar y\nproperty uchar z\n"
                           "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
        for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size())
            text.replace(at, 1, end);
        const auto model = load("a.ply", text + std::string("\n\0\0\13\0\0\n\1\0", 9) +
                                             std::string("\3\0\1\2", 4));
        ASSERT_TRUE(model.ok()) << model.status().message();
        EXPECT_EQ(model->triangles.size(), 1u);
    }
}

} // namespace
} // namespace tessera::corpus
