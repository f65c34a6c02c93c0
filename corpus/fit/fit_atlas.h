// The atlas of a mesh for a fit, and the fields on it.
#pragma once

#include "corpus/fit/texture_field.h"
#include "corpus/model_surface/model_atlas.h"

namespace tessera::corpus {

// Texels per world unit with which a texel is as large as the pixels that see the surface from
// nearby: all but a twentieth of the pixels are larger. Errors: bad_argument if no photograph sees
// the mesh.
Result<double> density_of_pixels(const Model& model, std::span<const PosedPhotograph> photographs);

// A field with `finer` times as many places along u and v as the atlas, and the charts of its places.
TextureField make_field(const ModelAtlas& atlas, std::uint32_t finer, std::uint32_t directions);
// A field that all places share.
TextureField make_shared_field(std::uint32_t directions);

// Of each place of a field, u fastest: whether samples on the mesh can see it.
std::vector<bool> visible_places(const SurfaceMesh& mesh, const TextureField& field);

} // namespace tessera::corpus
