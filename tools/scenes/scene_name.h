// The names of built-in scenes on the command line.
#pragma once

#include "format/status.h"

#include <string>
#include <vector>

namespace tessera {

std::vector<std::string> scene_names();

// Checks that the scene exists. Errors: bad_argument; the message lists all names and suggests the
// closest one.
Status check_scene(const std::string& name);

} // namespace tessera
