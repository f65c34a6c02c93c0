// Tests reading of model files, both valid and hostile ones.
#include "corpus/trace/environment.h"
#include "tests/support/model_files.h"

#include <cmath>

namespace tessera::corpus {
namespace {

using namespace support;

class Models : public ModelFiles {};

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

// A tool turned a face and left its normals.
TEST_F(Models, NormalsBehindTheirTriangleAreTurned) {
    GltfText text;
    text.attributes = R"(,"NORMAL":2)";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":3})";
    text.views = R"(,{"buffer":2,"byteLength":36})";
    const auto normals = [&](const std::vector<float>& values) {
        text.buffers = R"(,{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                       base64_of(values) + R"("})";
        const auto model = load("a.gltf", text.text());
        EXPECT_TRUE(model.ok()) << model.status().message();
        std::vector<glm::vec3> found;
        for (const std::uint32_t i : model->triangles[0].vertices)
            found.push_back(model->vertices[i].normal);
        return found;
    };
    for (const glm::vec3& n : normals({0, 0, -1, 0, 0, -1, 0, 0.6f, -0.8f}))
        EXPECT_GT(n.z, 0.7f);
    // One that points behind may be meant.
    EXPECT_LT(normals({0, 0, 1, 0, 0, 1, 0, 0.6f, -0.8f})[2].z, -0.7f);
}

// Chains of bones and ropes are deep.
TEST_F(Models, NodesMayBeDeep) {
    const auto chain = [](int nodes) {
        GltfText text;
        text.nodes.clear();
        for (int i = 1; i < nodes; ++i)
            text.nodes += R"({"children":[)" + std::to_string(i) + "]},";
        text.nodes += R"({"mesh":0})";
        return text.text();
    };
    const auto deep = load("a.gltf", chain(1000));
    EXPECT_TRUE(deep.ok()) << deep.status().message();
    refuse("b.gltf", chain(1001), ErrorCode::invalid_file, "more than 1000 levels deep");
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
        R"("pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,0.25],"metallicFactor":0.5,"roughnessFactor":0.75}}])";
    const auto model = load("a.gltf", text.text());
    ASSERT_TRUE(model.ok()) << model.status().message();
    const ModelMaterial& m = model->materials[model->triangles[0].material];
    EXPECT_EQ(m.base, glm::dvec4(0.5, 0.25, 1, 0.25));
    EXPECT_EQ(m.metal, 0.5);
    EXPECT_EQ(m.roughness, 0.75);
    EXPECT_EQ(m.emission, glm::dvec3(0, 1, 0));
    EXPECT_EQ(m.cutoff, 0.5);
    EXPECT_TRUE(m.double_sided);
}

TEST_F(Models, HostileGltfIsRefused) {
    GltfText nan;
    nan.positions[4] = std::numeric_limits<float>::quiet_NaN();
    refuse("nan.gltf", nan.text(), ErrorCode::invalid_file, "positions are no numbers");
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
    GltfText extension;
    extension.more = R"(,"extensionsRequired":["KHR_animation_pointer"])";
    refuse("ext.gltf", extension.text(), ErrorCode::unsupported, "KHR_animation_pointer");
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
           "bufferView 0 lies outside its buffer");
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

TEST_F(Models, ObjPolygons) {
    // From behind, by indices from the end; a corner points inwards, so not every pair of triangles
    // fits.
    const auto dart = load("dart.obj", "v 0 0 0\nv 10 0.5 0\nv 0 1 0\nv 1 0.5 0\nf -1 -2 -3 -4\n");
    ASSERT_TRUE(dart.ok()) << dart.status().message();
    EXPECT_EQ(dart->triangles.size(), 2u);
    double area = 0;
    for (const ModelTriangle& t : dart->triangles) {
        const glm::vec3 a = dart->vertices[t.vertices[0]].position;
        const glm::vec3 cross = glm::cross(dart->vertices[t.vertices[1]].position - a,
                                           dart->vertices[t.vertices[2]].position - a);
        EXPECT_LT(cross.z, 0.0f);
        area += 0.5 * static_cast<double>(glm::length(cross));
    }
    const double scale = 3.5 / std::hypot(5.0, 0.5); // into the sphere
    EXPECT_NEAR(area, 4.5 * scale * scale, 1e-4);

    std::string circle, face = "f";
    constexpr int corners = 300;
    for (int i = 0; i < corners; ++i) {
        const double angle = 6.28318530717959 * i / corners;
        circle +=
            "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
        face += " " + std::to_string(i + 1);
    }
    const auto whole = load("circle.obj", circle + face);
    ASSERT_TRUE(whole.ok()) << whole.status().message();
    EXPECT_EQ(whole->triangles.size(), corners - 2u);

    // Points and lines add nothing.
    const auto flat =
        load("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1\nf 1 2\nl 1 2\nf 1 2 3 # f\\");
    ASSERT_TRUE(flat.ok()) << flat.status().message();
    EXPECT_EQ(flat->triangles.size(), 1u);
}

TEST_F(Models, MissingNormalsAreSmoothUpTo45Degrees) {
    // A roof of two squares that meet at an angle, four of whose corners lie on the ridge.
    const auto ridge_normal = [&](double height) {
        const std::string top = " " + std::to_string(height) + " ";
        const auto roof = load("roof.obj", "v -1 0 0\nv -1 0 1\nv 0" + top + "1\nv 0" + top +
                                               "0\nv 1 0 0\nv 1 0 1\nf 1 2 3 4\nf 4 3 6 5\n");
        EXPECT_TRUE(roof.ok()) << roof.status().message();
        double most = 0;
        for (const ModelVertex& v : roof->vertices)
            if (v.position.x == 0.0f)
                most = std::max(most, static_cast<double>(std::abs(v.normal.x)));
        return most;
    };
    EXPECT_NEAR(ridge_normal(std::tan(0.35)), 0.0, 1e-6);            // 40 degrees between them
    EXPECT_NEAR(ridge_normal(std::tan(0.44)), std::sin(0.44), 1e-5); // 50 degrees
}

TEST_F(Models, MaterialsOfObj) {
    file("one.png", one_texel_png);
    file("m.mtl", "newmtl red\nKd 1 0 0\nNs 100\nd 0.5\n"
                  "newmtl metal\nKd 0.5\nKe 0 1 0\nPr 0\nPm 1\n"
                  "newmtl with picture\nKd 0 0 0\nmap_Kd -o 1 2 -clamp on .\\one.png\n"
                  "newmtl bare\n");
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3/1 -2/2 -1/3\n";
    const auto model =
        load("m.obj", "\xEF\xBB\xBFmtllib m.mtl\r\nvt 0 0\r\nvt 1 \\\r\n 0.25\r\nvt 0 1\r\n" +
                          triangle + "usemtl red\n" + triangle + "g a b\nusemtl metal\n" +
                          triangle + "usemtl with picture \n" + triangle + "usemtl bare\n" +
                          triangle + "usemtl unknown\n" + triangle);
    ASSERT_TRUE(model.ok()) << model.status().message();
    ASSERT_EQ(model->triangles.size(), 6u);
    EXPECT_TRUE(model->notes.empty());
    const auto material = [&](std::size_t i) {
        return model->materials[model->triangles[i].material];
    };
    const double grey = srgb_to_linear(0.6), half = srgb_to_linear(0.5);
    for (const std::size_t i : {0, 4, 5})
        EXPECT_EQ(material(i).base, glm::dvec4(grey, grey, grey, 1)) << i;
    EXPECT_EQ(material(1).base, glm::dvec4(1, 0, 0, 0.5));
    EXPECT_NEAR(material(1).roughness, std::pow(2.0 / 102.0, 0.25), 1e-9);
    EXPECT_EQ(material(1).metal, 0.0);
    EXPECT_EQ(material(2).base, glm::dvec4(half, half, half, 1));
    EXPECT_EQ(material(2).emission, glm::dvec3(0, 1, 0));
    EXPECT_EQ(material(2).roughness, 0.0);
    EXPECT_EQ(material(2).metal, 1.0);
    EXPECT_EQ(material(3).base, glm::dvec4(1.0));
    ASSERT_EQ(material(3).base_texture.image, 0);
    EXPECT_EQ(model->images[0].width, 1u);
    const ModelVertex& second = model->vertices[model->triangles[0].vertices[1]];
    EXPECT_EQ(second.uv[0], glm::vec2(1.0f, 0.75f)); // from the top

    file("gone.mtl", "newmtl m\nmap_Kd nowhere.png\n");
    const auto gone = load("gone.obj", "mtllib gone.mtl\n" + triangle);
    ASSERT_TRUE(gone.ok()) << gone.status().message();
    ASSERT_EQ(gone->notes.size(), 1u);
    EXPECT_NE(gone->notes[0].find("nowhere.png"), std::string::npos);
    file("wrong.mtl", "\nnewmtl m\nKd red\n");
    refuse("wrong.obj", "mtllib wrong.mtl\n" + triangle, ErrorCode::invalid_file,
           "wrong.mtl: line 3: 'red'");
}

TEST_F(Models, NamesOfPicturesInMtl) {
    file("a b.png", one_texel_png);
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    for (const char* name :
         {"a b.png ", "\"a b.png\"", ".\\a b.png", "C:\\work\\a b.png", "/home/me/maps/a b.png",
          "-s 2 2 2 -o 0 0 0 -bm 1.5 -clamp on -imfchan r a b.png"}) {
        file("a.mtl", std::string("newmtl m\nKd 0 0 0\nmap_Kd ") + name + "\n");
        const auto model = load("a.obj", "mtllib a.mtl\n" + triangle);
        ASSERT_TRUE(model.ok()) << name << ": " << model.status().message();
        EXPECT_TRUE(model->notes.empty()) << name;
        EXPECT_EQ(model->materials[model->triangles[0].material].base_texture.image, 0) << name;
    }
    file("a.mtl", "newmtl m\nmap_Ke a b.png\nnorm a b.png\nmap_Bump a b.png\nmap_Pr a b.png\n"
                  "newmtl n\nmap_Bump a b.png\n");
    const auto model = load("a.obj", "mtllib a.mtl\n" + triangle);
    ASSERT_TRUE(model.ok()) << model.status().message();
    const ModelMaterial& m = model->materials[model->triangles[0].material];
    EXPECT_EQ(m.emission, glm::dvec3(1.0));
    EXPECT_EQ(m.emission_texture.image, 0);
    EXPECT_EQ(m.normal_texture.image, 0);
    EXPECT_EQ(model->notes,
              std::vector<std::string>{
                  "map_bump (1 material) is grey and is taken for heights, which become normals"});
}

// A binary PPM of 1x1 or more pixels of one colour.
std::string flat_ppm(unsigned side, const std::string& colour) {
    std::string text = "P6 " + std::to_string(side) + " " + std::to_string(side) + " 255\n";
    for (unsigned i = 0; i < side * side; ++i)
        text += colour;
    return text;
}

TEST_F(Models, RoughnessMetalAndBumpOfObj) {
    const std::string triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    file("rough.ppm", flat_ppm(2, "\x40\x40\x40"));
    file("metal.ppm", flat_ppm(1, "\x80\x80\x80"));
    file("normal.ppm", flat_ppm(1, "\x80\x80\xff"));
    file("height.ppm", flat_ppm(1, "\x70\x71\x72"));
    file("a.mtl", "newmtl m\nPr 0.1\nPm 0.2\nmap_Pr rough.ppm\nmap_Pm -imfchan r metal.ppm\n"
                  "map_Bump -bm 1.5 normal.ppm\n");
    auto model = load("a.obj", triangle);
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_EQ(model->notes,
              std::vector<std::string>{"map_bump (1 material) is blue and is taken for normals"});
    const ModelMaterial& both = model->materials[model->triangles[0].material];
    EXPECT_EQ(both.roughness, 1.0); // the maps replace the numbers
    EXPECT_EQ(both.metal, 1.0);
    const Image& joined =
        model->images[static_cast<std::size_t>(both.metal_roughness_texture.image)];
    EXPECT_EQ(joined.width, 2u);
    for (const auto& texel : joined.texels)
        EXPECT_EQ(texel, (std::array<std::uint8_t, 4>{255, 0x40, 0x80, 255}));
    EXPECT_EQ(both.normal_scale, 1.5);
    EXPECT_EQ(model->images[static_cast<std::size_t>(both.normal_texture.image)].texels[0][2], 255);
    file("a.mtl", "newmtl m\nPr 0.25\nmap_Pm metal.ppm\nbump height.ppm\n");
    model = load("a.obj", triangle);
    ASSERT_TRUE(model.ok()) << model.status().message();
    const ModelMaterial& one = model->materials[model->triangles[0].material];
    EXPECT_EQ(one.roughness, 0.25);
    const Image& flat = model->images[static_cast<std::size_t>(one.normal_texture.image)];
    EXPECT_EQ(flat.texels[0], (std::array<std::uint8_t, 4>{128, 128, 255, 255}));
}

// Heights that rise to the right and, in the picture, downwards.
TEST_F(Models, BumpMapsOfHeightsBecomeNormals) {
    file("h.pgm", "P2 3 2 255\n0 51 102\n51 102 153\n");
    file("a.mtl", "newmtl m\nbump -bm 2 h.pgm\nnewmtl n\nbump -bm 2 h.pgm\n");
    const auto model = load("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                     "usemtl m\nf 1 2 3\nusemtl n\nf 1 3 2\n");
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_EQ(model->notes,
              std::vector<std::string>{"map_bump (2 materials) is grey and is taken for heights, "
                                       "which become normals"});
    EXPECT_EQ(model->images.size(), 2u); // both materials share it
    const ModelMaterial& m = model->materials[model->triangles[0].material];
    EXPECT_EQ(m.normal_scale, 1.0);
    const Image& normals = model->images[static_cast<std::size_t>(m.normal_texture.image)];
    // In the middle of the first row the heights rise by 0.2 a texel; both neighbours above and
    // below are the same row.
    const glm::dvec3 n = glm::normalize(glm::dvec3(-0.4, 0.0, 1.0));
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(normals.texels[1][c], 127.5 + 127.5 * n[static_cast<glm::length_t>(c)], 1.0);
    file("tall.pgm", "P2 1 3 255\n0 51 102\n");
    file("a.mtl", "newmtl m\nbump tall.pgm\n");
    const auto tall = load("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    ASSERT_TRUE(tall.ok());
    const Image& up = tall->images[static_cast<std::size_t>(
        tall->materials[tall->triangles[0].material].normal_texture.image)];
    // It rises downwards, so the normal points upwards.
    EXPECT_NEAR(up.texels[1][1], 127.5 + 127.5 * glm::normalize(glm::dvec3(0, 0.2, 1)).y, 1.0);
}

// Statements that change nothing are not named.
TEST_F(Models, UnusedStatementsOfMtlAreNamedAndClearCoatsAreRead) {
    const std::string triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    file("a.mtl", "newmtl m\nTf 1 1 1\nd 1.0\nTr 0\nPs 0\naniso 0\nPc 0.5\nPcr 0.25\n");
    auto model = load("a.obj", triangle);
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    const auto& coats = model->materials[model->triangles[0].material].coats;
    ASSERT_TRUE(coats);
    EXPECT_EQ(coats->clear, 0.5);
    EXPECT_EQ(coats->clear_roughness, 0.25);
    file("a.mtl", "newmtl m\nTf 0.5 1 1\nd 0\nPs 1\nnorm -s 2 2 2 gone.png\n");
    model = load("a.obj", triangle);
    ASSERT_TRUE(model.ok());
    EXPECT_FALSE(model->materials[model->triangles[0].material].coats);
    for (const char* statement : {"-s, -o or -clamp of norm", "d", "ps", "tf"})
        EXPECT_EQ(std::ranges::count(model->notes,
                                     statement + std::string(" (1 material) is not supported and "
                                                             "is ignored")),
                  1)
            << statement;
}

TEST_F(Models, TransparencyOfMtlBlends) {
    const std::string triangle = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                 "usemtl m\nf 1/1 2/2 3/3\n";
    file("green.ppm", flat_ppm(1, std::string("\0\xff\0", 3)));
    file("grey.ppm", flat_ppm(2, "\x40\x40\x40"));
    const auto material = [&](const std::string& statements, Image* picture = nullptr) {
        file("a.mtl", "newmtl m\n" + statements);
        const auto model = load("a.obj", triangle);
        EXPECT_TRUE(model.ok()) << model.status().message();
        EXPECT_TRUE(model->notes.empty()) << model->notes[0];
        const ModelMaterial m = model->materials[model->triangles[0].material];
        if (picture)
            *picture = model->images[static_cast<std::size_t>(m.base_texture.image)];
        return m;
    };
    for (const char* half : {"d 0.25\n", "d -halo 0.25\n", "Tr 0.75\n"}) {
        EXPECT_TRUE(material(half).blends) << half;
        EXPECT_EQ(material(half).base.a, 0.25) << half;
    }
    Image picture;
    EXPECT_TRUE(material("map_Kd green.ppm\nmap_d grey.ppm\n", &picture).blends);
    ASSERT_EQ(picture.texels.size(), 4u);
    EXPECT_EQ(picture.texels[3], (std::array<std::uint8_t, 4>{0, 255, 0, 0x40}));
    EXPECT_TRUE(material("map_d grey.ppm\n", &picture).blends);
    EXPECT_EQ(picture.texels[0], (std::array<std::uint8_t, 4>{255, 255, 255, 0x40}));
}

TEST_F(Models, OptionsOfMtlPlaceThePicture) {
    file("green.ppm", flat_ppm(1, std::string("\0\xff\0", 3)));
    file("a.mtl", "newmtl m\nmap_Kd -s 2 4 1 -o 0.5 0.25 -clamp on green.ppm\n");
    const auto model = load("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
                                     "vt 0 1\nusemtl m\nf 1/1 2/2 3/3\n");
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_TRUE(model->notes.empty());
    const TextureUse& use = model->materials[model->triangles[0].material].base_texture;
    EXPECT_EQ(use.turn * glm::dvec2(0.5, 1.0 - 0.5) + use.offset,
              glm::dvec2(2 * 0.5 + 0.5, 1.0 - (4 * 0.5 + 0.25))); // v downwards
    EXPECT_EQ(use.wrap_u, Wrap::clamp);
}

TEST_F(Models, FilesOfOtherKindsAreNamed) {
    const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\n";
    for (const char* name : {"a.gltf", "a.glb", "a.obj", "a.ply"}) {
        refuse(name, pointer, ErrorCode::invalid_file, "not a model, but a Git LFS pointer");
        refuse(name, "\n <!DOCTYPE HTML><html>", ErrorCode::invalid_file, "an HTML page");
        refuse(name, "PK\3\4zip", ErrorCode::invalid_file, "a ZIP archive");
        refuse(name, "", ErrorCode::invalid_file, "an empty file");
    }
    refuse("b.gltf", R"({"asset":{"version":"1.0"}})", ErrorCode::unsupported, "is glTF 1.0");
    refuse("c.gltf", R"({"asset":{"version":"2.1","minVersion":"2.1"}})", ErrorCode::unsupported,
           "is glTF 2.1");
}

TEST_F(Models, ObjWithoutItsMaterialFile) {
    const std::string text =
        "mtllib gone one.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto without = load("a.obj", text);
    ASSERT_TRUE(without.ok()) << without.status().message();
    ASSERT_EQ(without->notes.size(), 1u);
    EXPECT_EQ(without->notes[0],
              "the material file 'gone one.mtl' is missing; its materials are grey");
    file("a.mtl", "newmtl red\nKd 1 0 0\n"); // beside the .obj, with its name
    const auto beside = load("a.obj", text);
    ASSERT_TRUE(beside.ok()) << beside.status().message();
    EXPECT_TRUE(beside->notes.empty());
    EXPECT_EQ(beside->materials[beside->triangles[0].material].base, glm::dvec4(1, 0, 0, 1));
    file("gone one.mtl", "newmtl red\nKd 0 1 0\n");
    const auto with = load("a.obj", text);
    ASSERT_TRUE(with.ok()) << with.status().message();
    EXPECT_EQ(with->materials[with->triangles[0].material].base, glm::dvec4(0, 1, 0, 1));
}

TEST_F(Models, ColoursAndHomogeneousCoordinatesOfObj) {
    const auto model = load("a.obj", "v 0 0 0 1 0 0\nv 2 0 0 2\nv 0 1,0 0 0 1 0\nvn 0 0 1\n"
                                     "vt 0,5\nf 1/1/1 2//1 3/1/9\n");
    ASSERT_TRUE(model.ok()) << model.status().message();
    const auto& t = model->triangles[0].vertices;
    EXPECT_EQ(model->vertices[t[0]].colour, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(model->vertices[t[1]].colour, glm::vec4(1.0f));
    EXPECT_EQ(model->vertices[t[0]].uv[0], glm::vec2(0.5f, 1.0f));
    EXPECT_EQ(model->vertices[t[2]].normal, glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::distance(model->vertices[t[0]].position, model->vertices[t[1]].position),
                glm::distance(model->vertices[t[0]].position, model->vertices[t[2]].position),
                1e-5);
}

// A shell of Windows writes UTF-16 where text is sent to a file.
TEST_F(Models, ObjInUtf16) {
    const std::string obj = "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const auto utf16 = [](const std::string& text, bool big) {
        std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
        for (const char c : text)
            wide += big ? std::string{'\0', c} : std::string{c, '\0'};
        return wide;
    };
    for (const bool big : {false, true}) {
        file("a.mtl", utf16("newmtl red\nKd 1 0 0\n", big));
        const auto model = load("a.obj", utf16(obj, big));
        ASSERT_TRUE(model.ok()) << model.status().message();
        EXPECT_TRUE(model->notes.empty());
        EXPECT_EQ(model->materials[model->triangles[0].material].base, glm::dvec4(1, 0, 0, 1));
    }
    EXPECT_FALSE(load("cut.obj", "\xFE\xFF\xD8").ok());
    EXPECT_FALSE(load("half.obj", std::string("\xFF\xFE\x00\xD8\x41\x00", 6)).ok());
}

TEST_F(Models, HostileObjIsRefused) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    refuse("a.obj", corners + "f 1 2 4\n", ErrorCode::invalid_file,
           "mesh 0: face 0 has vertex 3 of 3");
    refuse("b.obj", corners + "f 1 2 0\n", ErrorCode::invalid_file, "line 4: '0'");
    refuse("c.obj", corners + "f 1 2 -4\n", ErrorCode::invalid_file, "has vertex -1 of 3");
    refuse("d.obj", corners + "f 1/1/1/1 2 3\n", ErrorCode::invalid_file, "line 4: '1/1/1/1'");
    refuse("e.obj", "v 0 0\n", ErrorCode::invalid_file, "line 1: 'v' has too few numbers");
    refuse("f.obj", "v 0 0 x\n", ErrorCode::invalid_file, "line 1: 'x' is not a number");
    refuse("g.obj", "v 0 0 0 0\n" + corners + "f 1 2 3\n", ErrorCode::invalid_file,
           "positions are no numbers");
    refuse("h.obj", corners, ErrorCode::unsupported, "a point cloud, not a mesh");
    // A comb: cutting one tooth after another off it takes time with the square of their number.
    std::string comb, face = "f";
    for (int i = 0; i < 100'000; ++i)
        comb += "v " + std::to_string(i) + (i % 2 ? " 100 0\n" : " 0 0\n");
    for (int i = 1; i <= 100'002; ++i)
        face += " " + std::to_string(i);
    refuse("i.obj", comb + "v 100000 200 0\nv 0 200 0\n" + face, ErrorCode::unsupported,
           "too many corners");
}

TEST_F(Models, UnknownKindsAndMissingFiles) {
    EXPECT_EQ(load("a.step", "").status().code(), ErrorCode::bad_argument);
    for (const char* name : {"no.gltf", "no.obj", "no.ply", "no.stl"}) {
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
