// The cameras of glTF nodes.
#pragma once

#include "corpus/model/gltf_accessors.h"
#include "corpus/model/model.h"

#include <glm/mat4x4.hpp>

namespace tessera::corpus {

// Collects the cameras of the nodes that a scene visits.
class GltfCameras {
public:
    // Takes the camera of the node, if it has one. `place` is the node's transform.
    void add(const tinygltf::Model& file, const tinygltf::Node& node, const glm::dmat4& place);
    // Adds the cameras to the model, and notes those that were skipped.
    void finish(Model& model) &&;

private:
    std::vector<ModelCamera> cameras_;
    std::size_t skipped_ = 0; // not perspective, without a direction, or too many
};

} // namespace tessera::corpus
