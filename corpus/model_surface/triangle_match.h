// Which triangle of a mesh is which of the same mesh before it was coded.
#pragma once

#include "corpus/surface/atlas.h"
#include "format/surface_mesh.h"

namespace tessera::corpus {

struct MatchedTriangle {
    std::uint32_t triangle = 0; // before
    std::uint32_t turn = 0;     // corner k was corner (k + turn) % 3
};

// By the places in the atlas, which quantisation moves by a fraction of a texel. Errors: runtime.
Result<std::vector<MatchedTriangle>> match_triangles(const SurfaceMesh& before,
                                                     const SurfaceMesh& after, const Texels2& size);

} // namespace tessera::corpus
