#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// Makes materials opaque whose alpha removes nothing. Many files let all materials blend, and then
// their insides would count as visible.
void ignore_opaque_alpha(Model& model);

} // namespace tessera::corpus
