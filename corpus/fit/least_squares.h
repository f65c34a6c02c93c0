// The texture fields that explain photographs best.
#pragma once

#include "corpus/fit/texture_field.h"

#include <span>

namespace tessera::corpus {

using PixelColours = std::vector<std::array<float, 3>>;

// The colours of all pixels: the sum of the fields, without the share of the background. The result
// does not depend on the number of threads.
PixelColours predict(std::span<const TextureField> fields, const PhotoSamples& samples,
                     unsigned threads);

// The mean over the texels that are seen of the squared weights with which the pixels see them. It
// makes costs of neighbours independent of the number of photographs.
double seen_weight(const TextureField& field, const PhotoSamples& samples);

// Of each texel of a field: whether a pixel that counts sees it.
std::vector<bool> seen_texels(const TextureField& field, const PhotoSamples& samples);

// Changes the values of the fields such that the weighted squared error of all pixels and the costs
// of neighbours become least: `iterations` steps of conjugate gradients from the present values, with
// the diagonal as preconditioner. Memory: 8 times the values of all fields, per 32 threads. The
// result does not depend on the number of threads. Errors: runtime (interrupted, out of memory).
Status solve_least_squares(std::span<TextureField> fields, const PhotoSamples& samples,
                           unsigned iterations, const char* stage, const BakeRun& run);

} // namespace tessera::corpus
