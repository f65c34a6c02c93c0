// Models. The first byte says which kind (g: .gltf, b: .glb, o: .obj, p: .ply, s: .stl), the rest
// is the file.
#include "corpus/model/model.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/model_files.h"

#include <unistd.h>

namespace tessera::fuzz::model {
namespace {

const char* ending_of(char kind) {
    switch (kind) {
    case 'g':
        return ".gltf";
    case 'b':
        return ".glb";
    case 'p':
        return ".ply";
    case 's':
        return ".stl";
    default:
        return ".obj";
    }
}

} // namespace

std::vector<Bytes> seeds() {
    corpus::support::GltfText with_material;
    with_material.primitive = R"(,"material":0)";
    with_material.more =
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"metallicFactor":0.5}}])";
    corpus::support::GltfText extended;
    extended.nodes = R"({"mesh":0,"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}})";
    extended.primitive = R"(,"material":0)";
    extended.more =
        R"(,"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","range":3,"color":[1,0,1],)"
        R"("spot":{"innerConeAngle":0.1,"outerConeAngle":0.5}}]}},"materials":[{"extensions":{)"
        R"("KHR_materials_unlit":{},"KHR_materials_ior":{"ior":2},"KHR_materials_specular":{)"
        R"("specularFactor":0.5,"specularColorFactor":[1,0.5,0]},)"
        R"("KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[1,0,0,1],)"
        R"("glossinessFactor":0.5},"KHR_materials_clearcoat":{"clearcoatFactor":1},)"
        R"("KHR_materials_sheen":{"sheenColorFactor":[1,0,1]},"KHR_materials_iridescence":{)"
        R"("iridescenceFactor":1,"iridescenceThicknessMaximum":300},"KHR_materials_anisotropy":{)"
        R"("anisotropyStrength":1},"KHR_materials_transmission":{"transmissionFactor":1},)"
        R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":2}}}],)"
        R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}])";
    corpus::support::GltfText compressed; // a sequence of indices by meshoptimizer
    compressed.views = R"(,{"buffer":1,"byteLength":12,"extensions":{"EXT_meshopt_compression":{)"
                       R"("buffer":2,"byteLength":8,"byteStride":4,"count":3,"mode":"INDICES"}}})";
    compressed.buffers =
        R"(,{"byteLength":8,"uri":"data:application/octet-stream;base64,)" +
        corpus::support::base64_of(std::vector<unsigned char>{0xd1, 0, 4, 4, 0, 0, 0, 0}) + R"("})";
    compressed.accessors = R"(,{"bufferView":2,"componentType":5125,"type":"SCALAR","count":3})";
    const std::string json = corpus::support::GltfText().text();
    std::string glb("glTF\2\0\0\0", 8);
    const auto add = [&glb](std::uint32_t n) { glb.append(reinterpret_cast<const char*>(&n), 4); };
    const std::string padded = json + std::string((4 - json.size() % 4) % 4, ' ');
    add(static_cast<std::uint32_t>(20 + padded.size()));
    add(static_cast<std::uint32_t>(padded.size()));
    glb += "JSON" + padded;
    return {
        bytes_of("g" + json),
        bytes_of("g" + with_material.text()),
        bytes_of("g" + extended.text()),
        bytes_of("g" + compressed.text()),
        bytes_of("b" + glb),
        bytes_of("ov 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"),
        bytes_of(
            "omtllib a.mtl\nusemtl a\nv 0 0 0 1 0 0\nv 4 0 0 1\nv 3,5 1 0\nv 4 4 0\nv 0 4 \\\n0\n"
            "vn 0 0 1\ng a b\nf 1//1 2//1 3//-1 4 -1\n"),
        bytes_of("pply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        bytes_of(
            "pply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty char x\n"
            "property short y\nproperty uint z\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nelement tristrips 1\nproperty list uchar ushort vertex_index\n"
            "end_header\n" +
            std::string("\0\0\0\0\0\0\0\1\1\1\1\0\0\0\0\0\0\2\2\2\0\0\1\0\0\0\0\3\3\3"
                        "\1\0\1\0\0\0\0\4\4\4\4\0\0\0\1\0\2\0\3",
                        49)),
        bytes_of("ssolid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                 "vertex 0 1 0\nendloop\nendfacet\nendsolid a\n"),
        bytes_of("s" + std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(12, '\0') +
                 std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0"
                             "\0\0\0\0\0\0\x80\x3f\0\0\0\0\1\0",
                             38))};
}

void run(const std::uint8_t* data, std::size_t size) {
    if (size == 0)
        return;
    const std::string path =
        "/tmp/tessera_fuzz_" + std::to_string(::getpid()) + ending_of(static_cast<char>(data[0]));
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
    const auto model = corpus::load_model(path);
    ::unlink(path.c_str());
    if (!model.ok())
        return;
    require(!model->materials.empty(), "a model without materials");
    for (const corpus::ModelTriangle& triangle : model->triangles) {
        require(triangle.material < model->materials.size(), "a material that is not there");
        for (const std::uint32_t corner : triangle.vertices)
            require(corner < model->vertices.size(), "a corner that is no vertex");
    }
}

const Registered registered({.name = "fuzz_model", .seeds = seeds, .run = run, .rounds = 400});

} // namespace tessera::fuzz::model
