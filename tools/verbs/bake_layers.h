// A model as layers, for `tessera bake`.
#pragma once

#include "tools/verbs/bake_sources.h"

namespace tessera {

// Whether layers can honour all options of the command. Errors: bad_argument.
Status check_layered(const BakeCommand& a);

// Bakes a model into a file with layers, and reports it. Errors: those of corpus/layers and of
// encoding; io.
Status bake_layered(const BakeCommand& a, ModelToBake model);

} // namespace tessera
