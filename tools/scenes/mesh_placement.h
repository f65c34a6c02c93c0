// Where the mesh of a baked model lies beside the model's own file.
#pragma once

#include "corpus/model/model.h"
#include "format/metadata.h"

#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

namespace tessera {

// A place in the mesh is scale * (place in the model's file) + offset.
struct MeshPlacement {
    double scale = 1.0; // above 0
    glm::dvec3 offset{0.0};
    bool moves() const { return scale != 1.0 || offset != glm::dvec3(0.0); }
};

// The mesh keeps the units and the place of the model, unless 32-bit floats or cameras cannot express
// them: it becomes as large as the paper's sphere if its radius is not within 0.001 to 100,000, and
// moves to the origin if that is more than 64 radii away.
MeshPlacement placement_of(const corpus::ModelFrame& frame);

// Where the baker sees a mesh of that placement.
corpus::ModelFrame frame_of_mesh(const corpus::ModelFrame& frame, const MeshPlacement& placement);

// As metadata. All bakes of models have it since their meshes keep the model's units.
std::vector<std::pair<std::string, std::string>> facts_of(const MeshPlacement& placement);

// The frame of the mesh in a file with this metadata, which was baked from a model with `frame`.
// Error: invalid_file if the metadata cannot be read.
Result<corpus::ModelFrame> frame_of_mesh(const corpus::ModelFrame& frame, const Metadata& metadata);

// For people; empty if nothing moves.
std::string placement_note(const MeshPlacement& placement);

} // namespace tessera
