// Names of built-in scenes, as they are typed.
#pragma once

#include "format/status.h"

#include <string>
#include <vector>

namespace tessera {

std::vector<std::string> scene_names();

// Errors: bad_argument, with the names that there are and the nearest.
Status check_scene(const std::string& name);

} // namespace tessera
