// The pose in which a glTF file rests: weights of morph targets, and joints of skins.
#pragma once

#include "corpus/model/gltf_accessors.h"

#include <glm/mat4x4.hpp>
#include <optional>

namespace tessera::corpus {

constexpr int deepest_node = 1'000; // levels of nodes

// The transform of a node below its parent.
glm::dmat4 transform_of(const tinygltf::Node& node);

// The node above each node; -1: none.
std::vector<int> parents_of(const tinygltf::Model& file);

// Adds the morph targets of the primitive to the part, each times its weight. Targets without a
// weight stay out. Errors: invalid_file, unsupported (those of read_accessor()).
Status add_targets(const tinygltf::Model& file, const tinygltf::Primitive& primitive,
                   const std::vector<double>& weights, ModelPart& part);

class GltfSkins {
public:
    explicit GltfSkins(const tinygltf::Model& file);

    // Moves the vertices of the part, which has joints, to where the skin's joints put them in the
    // world. Triangles that joints mirror are turned. Error: invalid_file (no such skin or joint).
    Status apply(int skin, ModelPart& part);

private:
    // What the joints of a skin do to its vertices.
    Result<const std::vector<glm::dmat4>*> joints_of(int skin);
    // From a node to the world. Error: invalid_file (no such node, below itself).
    Result<glm::dmat4> place_of(int node);

    const tinygltf::Model& file_;
    std::vector<int> parents_;                      // of nodes
    std::vector<std::optional<glm::dmat4>> places_; // of nodes, as far as they are known
    std::map<int, std::vector<glm::dmat4>> joints_;
};

} // namespace tessera::corpus
