#include "tools/scenes/scene_name.h"

#include "corpus/catalog.h"
#include "tools/support/suggestions.h"

namespace tessera {

std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const corpus::SceneInfo& scene : corpus::scenes())
        names.push_back(scene.name);
    return names;
}

Status check_scene(const std::string& name) {
    const Status found = corpus::find_scene(name).status();
    return found.ok() ? found
                      : Status(found.code(), found.message() + did_you_mean(name, scene_names()));
}

} // namespace tessera
