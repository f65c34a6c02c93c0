// Puts a model together from parts of a file, each of which is checked.
#pragma once

#include "corpus/model/model.h"

#include <map>

namespace tessera::corpus {

// A part of a model as a file has it. What is empty is absent.
struct ModelPart {
    std::string name; // for messages: "mesh 0, primitive 2"
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents, colours;
    std::array<std::vector<glm::vec2>, 2> uv;
    std::vector<std::uint32_t> indices; // three a triangle
    std::uint32_t material = 0;
};

class ModelBuilder {
public:
    // Triangles without area are left out; normals that are missing are those of the triangles.
    // Errors: invalid_file, naming the part and the element; unsupported (too many triangles).
    Status add(const ModelPart& part, const glm::dmat4& to_world);
    // Materials and images must be there. Errors: invalid_file, no triangle has an area.
    Result<Model> finish() &&;

    // The number of the picture in this file, which is read once. Errors: io, invalid_file, unsupported,
    // naming the picture.
    Result<int> add_image(const std::string& path);

    Model& model() { return model_; }

private:
    Model model_;
    std::map<std::string, int> images_; // by path
    std::size_t flat_ = 0;              // triangles without area
};

} // namespace tessera::corpus
