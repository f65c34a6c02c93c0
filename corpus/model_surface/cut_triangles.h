// Cuts large triangles, so that charts of one density can be made of their parts.
#pragma once

#include "corpus/model_surface/viewed_scale.h"

#include <optional>

namespace tessera::corpus {

// Cuts triangles whose places are viewed from very different distances, such as a floor around small
// things. Nothing if there are none. All triangles at an edge are cut at the same place, and at most
// as many are added as the model has, or some thousands.
std::optional<Model> with_cut_triangles(const Model& model, const ViewedScale& scale);

} // namespace tessera::corpus
