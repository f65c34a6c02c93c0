// Checks the parts of a file and joins them into a model.
#pragma once

#include "corpus/model/model.h"

#include <map>

namespace tessera::corpus {

constexpr std::size_t most_triangles = std::size_t{1} << 22; // of a model

// Four joints of each vertex, and how much it follows them.
struct SkinUse {
    std::vector<glm::vec4> joints, weights;
};

// A part of a model as a file has it. Vectors of absent attributes are empty.
struct ModelPart {
    std::string name; // for messages: "mesh 0, primitive 2"
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents, colours;
    std::array<std::vector<glm::vec2>, 2> uv;
    std::vector<SkinUse> skin;          // sets of joints; the builder does not use them
    std::vector<std::uint32_t> indices; // three per triangle
    std::uint32_t material = 0;
};

class ModelBuilder {
public:
    // Omits triangles without area and those whose positions are not numbers. Missing normals are
    // those of the triangles. Notes what is not a number. Errors: invalid_file, naming the part and
    // the element; unsupported (too many triangles).
    Status add(const ModelPart& part, const glm::dmat4& to_world);
    // Precondition: model() has its materials and images. Error: invalid_file (no triangle with an
    // area, too large).
    Result<Model> finish() &&;

    // Reads the picture unless it has been read, and returns its index in Model::images. Notes
    // pictures that cannot be read, and returns -1 for them.
    int add_image_or_note(const std::string& path);

    Model& model() { return model_; }

private:
    Model model_;
    std::map<std::string, int> images_; // by path
    std::size_t flat_ = 0;              // triangles without area
    std::size_t nowhere_ = 0;           // triangles whose positions are not numbers
};

} // namespace tessera::corpus
