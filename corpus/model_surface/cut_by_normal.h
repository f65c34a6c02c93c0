// Pieces of a model that are almost flat.
#pragma once

#include "corpus/model_surface/facets.h"

#include <span>

namespace tessera::corpus {

// The triangles of each piece. Pieces are connected, and their normals differ little.
std::vector<std::vector<std::uint32_t>> cut_by_normal(const Facets& facets,
                                                      std::span<const double> texels);

} // namespace tessera::corpus
