// Tests the pose in which glTF files rest: skins and morph targets.
#include "tests/support/gltf_fixture.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

namespace tessera::corpus {
namespace {

using namespace support;

class GltfPose : public GltfFixture {
protected:
    // The vertices of the file's only triangle, in the units of the file.
    std::array<glm::dvec3, 3> corners(const GltfText& text) const {
        const auto model = load(text);
        EXPECT_TRUE(model.ok()) << model.status().message();
        std::array<glm::dvec3, 3> places{};
        if (!model.ok())
            return places;
        EXPECT_TRUE(model->notes.empty()) << model->notes[0];
        for (std::size_t k = 0; k < 3; ++k)
            places[k] = model->frame.to_file(
                glm::dvec3(model->vertices[model->triangles[0].vertices[k]].position));
        return places;
    }
};

void expect_near(const glm::dvec3& a, const glm::dvec3& b) {
    EXPECT_LT(glm::distance(a, b), 1e-5) << a.x << ' ' << a.y << ' ' << a.z;
}

// A triangle whose vertices follow nodes 1, 1 and 2; buffer 2 has the joints, the weights and the
// inverse bind matrix of node 1, which moves by -1 in x.
GltfText skinned(const std::string& node1, const std::string& node2) {
    GltfText text;
    std::vector<float> numbers{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, // joints
                               2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, // weights, whose sum is not 1
                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1,
                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1};
    text.buffers = R"(,{"byteLength":224,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(numbers) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":48},{"buffer":2,"byteOffset":48,"byteLength":48},)"
                 R"({"buffer":2,"byteOffset":96,"byteLength":128})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC4","count":3},)"
                     R"({"bufferView":3,"componentType":5126,"type":"VEC4","count":3},)"
                     R"({"bufferView":4,"componentType":5126,"type":"MAT4","count":2})";
    text.attributes = R"(,"JOINTS_0":2,"WEIGHTS_0":3)";
    // The transform of a node with a skin does not count.
    text.nodes = R"({"mesh":0,"skin":0,"translation":[50,0,0],"scale":[0,0,0]},{"children":[2],)" +
                 node1 + "},{" + node2 + "}";
    text.more = R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":4}])";
    return text;
}

TEST_F(GltfPose, SkinsMoveVertices) {
    const auto places = corners(skinned(R"("translation":[3,0,0])", R"("translation":[0,0,4])"));
    expect_near(places[0], {2, 0, 0});
    expect_near(places[1], {3, 0, 0});
    expect_near(places[2], {3, 1, 4});
}

// A triangle as a Draco stream of positions, joints and weights, whose ids are 0, 1 and 2.
std::vector<std::uint32_t> draco_triangle(const std::vector<float>& positions,
                                          const std::vector<float>& joints,
                                          const std::vector<float>& weights) {
    draco::Mesh mesh;
    mesh.set_num_points(3);
    mesh.AddFace({draco::PointIndex(0), draco::PointIndex(1), draco::PointIndex(2)});
    const auto add = [&](draco::GeometryAttribute::Type type, std::uint8_t components,
                         const std::vector<float>& values) {
        draco::GeometryAttribute form;
        form.Init(type, nullptr, components, draco::DT_FLOAT32, false, components * sizeof(float),
                  0);
        const int id = mesh.AddAttribute(form, true, 3);
        for (std::uint32_t i = 0; i < 3; ++i)
            mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                                  &values[i * components]);
    };
    add(draco::GeometryAttribute::POSITION, 3, positions);
    add(draco::GeometryAttribute::GENERIC, 4, joints);
    add(draco::GeometryAttribute::GENERIC, 4, weights);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    draco::EncoderBuffer stream;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &stream).ok());
    std::vector<std::uint32_t> words((stream.size() + 3) / 4);
    std::memcpy(words.data(), stream.data(), stream.size());
    return words;
}

// The stream's values count, not those of the accessors beside it: all places are 10 higher, and the
// first vertex follows node 2, too.
TEST_F(GltfPose, SkinsOfDracoMoveVertices) {
    GltfText text = skinned(R"("translation":[3,0,0])", R"("translation":[0,0,4])");
    const std::vector<std::uint32_t> words =
        draco_triangle({0, 10, 0, 1, 10, 0, 0, 11, 0}, {1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0},
                       {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    const std::string size = std::to_string(4 * words.size());
    text.buffers += R"(,{"byteLength":)" + size +
                    R"(,"uri":"data:application/octet-stream;base64,)" + base64_of(words) + R"("})";
    text.views += R"(,{"buffer":3,"byteLength":)" + size + "}";
    text.primitive = R"(,"extensions":{"KHR_draco_mesh_compression":{"bufferView":5,"attributes":)"
                     R"({"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}})";
    const auto places = corners(text);
    expect_near(places[0], {3, 10, 4});
    expect_near(places[1], {3, 10, 0});
    expect_near(places[2], {3, 11, 4});
}

// A skeleton that mirrors turns no triangle inside out.
TEST_F(GltfPose, MirroringJointsKeepFronts) {
    const auto places = corners(skinned(R"("scale":[-1,1,1])", R"("name":"child")"));
    const glm::dvec3 front = glm::cross(places[1] - places[0], places[2] - places[0]);
    EXPECT_GT(front.z, 0.0);
}

TEST_F(GltfPose, HostileSkinsAreRefused) {
    const GltfText sound = skinned(R"("name":"a")", R"("name":"b")");
    const auto with = [&](const std::string& skins) {
        GltfText text = sound;
        text.more = R"(,"skins":[)" + skins + "]";
        return text;
    };
    refuse(with(R"({"joints":[1]})"), "vertex 2 has joint 1");
    refuse(with(R"({"joints":[1,9]})"), "node 9, a joint, does not exist");
    refuse(with(R"({"joints":[]})"), "skin 0");
    refuse(with(R"({"joints":[1,2],"inverseBindMatrices":0})"), "accessor 0 has the wrong type");
    GltfText none = sound;
    none.more = "";
    refuse(none, "skin 0 does not exist");
    GltfText cycle = sound;
    cycle.nodes = R"({"mesh":0,"skin":0},{"children":[2]},{"children":[1]})";
    refuse(cycle, "below itself");
    GltfText few = sound;
    few.accessors.replace(few.accessors.find(R"("count":3)"), 9, R"("count":2)");
    refuse(few, "joints");
}

TEST_F(GltfPose, MorphTargetsHaveTheirWeights) {
    GltfText text;
    const std::vector<float> moves{0, 0, 0, 2, 0, 0, 0, 4, 0};
    text.buffers = R"(,{"byteLength":36,"uri":"data:application/octet-stream;base64,)" +
                   base64_of(moves) + R"("})";
    text.views = R"(,{"buffer":2,"byteLength":36})";
    text.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":3})";
    text.primitive = R"(,"targets":[{"POSITION":2},{"POSITION":0}])";
    expect_near(corners(text)[2], {0, 1, 0}); // weights are 0 unless the file states them
    GltfText of_mesh = text;
    of_mesh.primitive += R"(}],"weights":[0.5,0],"extras":[{)";
    expect_near(corners(of_mesh)[1], {2, 0, 0});
    expect_near(corners(of_mesh)[2], {0, 3, 0});
    // Those of the node come first.
    GltfText of_node = of_mesh;
    of_node.nodes = R"({"mesh":0,"weights":[0,1]})";
    expect_near(corners(of_node)[2], {0, 2, 0});
    GltfText few = of_mesh;
    few.accessors = R"(,{"bufferView":2,"componentType":5126,"type":"VEC3","count":2})";
    refuse(few, "a morph target has 2 values of POSITION for 3 vertices");
}

} // namespace
} // namespace tessera::corpus
