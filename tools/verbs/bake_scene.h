// A built-in scene on its own surfaces, for `tessera bake --proxy mesh`.
#pragma once

#include "tools/verbs/bake_choice.h"

namespace tessera {

// Whether the command wants the scene on its own surfaces.
bool is_on_own_surfaces(const BakeCommand& a);

// Layers, if options allow them, where some objects shine: they are smaller (codec/decisions.csv).
// Errors: those of corpus::make_scene() and check_layered(); unsupported, if --layered asks for
// what layers cannot hold.
Result<BakeChoice> choose_scene_layers(const BakeCommand& a);

// Bakes a scene into a file with layers, and reports it. Errors: those of bake_scene_layers() and
// write_layers().
Status bake_layered_scene(const BakeCommand& a);

} // namespace tessera
