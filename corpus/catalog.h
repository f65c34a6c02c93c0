// The built-in scenes by name. README.md says what each is for.
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
    Extent4 default_size{0, 0, 0, 0}; // the size its numbers are usually quoted for
};

// Every scene, in the order of the README.
std::vector<SceneInfo> scenes();

// bad_argument, naming the scenes there are, if `name` is none of them.
Result<SceneInfo> find_scene(const std::string& name);

// The scene itself; same error. Building one takes microseconds.
Result<Scene> make_scene(const std::string& name);

} // namespace tessera::corpus
