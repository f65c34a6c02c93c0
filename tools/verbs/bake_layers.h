// `tessera bake --layered`: a model as layers.
#pragma once

#include "tools/verbs/bake_sources.h"

namespace tessera {

// Bakes the model of the command into a file with layers, and reports it. Errors: bad_argument, if
// options do not go together; those of corpus/layers and of encoding; io.
Status bake_layered(const BakeCommand& a);

} // namespace tessera
