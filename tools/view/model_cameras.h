// The cameras of a model in the metadata of its texture.
#pragma once

#include "corpus/model/model.h"
#include "format/metadata.h"
#include "tools/support/json_text.h"
#include "tools/view/camera.h"

#include <span>

namespace tessera {

inline constexpr const char* model_cameras_key = "Model cameras";

// A list of {"name", "eye", "forward", "up", "fov"}, as the value of the key.
std::string cameras_text(std::span<const corpus::ModelCamera> cameras);
// The list; empty if the file has none. Errors: invalid_file if the value is not such a list.
Result<std::vector<corpus::ModelCamera>> model_cameras_in(const Metadata& metadata);

// The pose and the field of view of the camera of this name. Errors: bad_argument, which names all
// cameras; those of model_cameras_in().
struct NamedCamera {
    CameraPose pose;
    double fov = 45.0; // vertical, degrees
};
Result<NamedCamera> find_camera(const Metadata& metadata, const std::string& name);

} // namespace tessera
