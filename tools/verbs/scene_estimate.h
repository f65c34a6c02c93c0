// What `tessera bake --proxy mesh` of a built-in scene will take.
#pragma once

#include "tools/verbs/bake_choice.h"

namespace tessera {

// Sets the estimates of the choice, from the texels of the scene's surfaces and the time of a few
// rays. Errors: those of make_scene_surface().
Status estimate_scene(const BakeCommand& a, const corpus::Scene& scene,
                      const corpus::SurfaceWish& wish, BakeChoice& choice);

} // namespace tessera
