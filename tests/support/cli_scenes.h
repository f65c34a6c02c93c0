// Scenes that the tests of the tool bake, and the quickest effort as options.
#pragma once

#include "tests/support/cli_fixture.h"
#include "tests/support/efforts.h"

#include <string>

namespace tessera::test::cli_scenes {

inline const std::string small_scene = "bake composed --size 32x16x9x5 --spp 2 ";
inline const std::string quick = "--effort " + std::to_string(quick_effort) + " ";

} // namespace tessera::test::cli_scenes
