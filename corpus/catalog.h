// The built-in scenes by name. README.md says what each of them tests.
#pragma once

#include "corpus/scene.h"
#include "format/status.h"

#include <string>
#include <vector>

namespace tessera::corpus {

struct SceneInfo {
    std::string name;
    std::string description; // one line
    SampleType type = SampleType::unorm8;
    Extent4 default_size{0, 0, 0, 0};
};

// All scenes, in the order of README.md.
std::vector<SceneInfo> scenes();

// Error: bad_argument, which lists the names of all scenes, if there is no scene of this name.
Result<SceneInfo> find_scene(const std::string& name);

// Builds the scene, which takes microseconds. Error: as find_scene().
Result<Scene> make_scene(const std::string& name);

} // namespace tessera::corpus
