#pragma once

#include "corpus/model/model.h"

namespace tessera::corpus {

// The vertex of the other side of a surface. Bumps keep their directions.
inline ModelVertex turned_vertex(ModelVertex v) {
    v.normal = -v.normal;
    v.tangent.w = -v.tangent.w;
    return v;
}

} // namespace tessera::corpus
