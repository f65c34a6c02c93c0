// Whether a file's tiles may have base pictures (FORMAT.md 3.4), and which, by trial.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/tile/base_picture.h"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace tessera {

// Whether the encoder tries them: not at low efforts, with corrections or on meshes.
bool may_have_base_pictures(const EncodePlan& plan);

// What parts of a texture cost with base pictures, or without any.
using CostOfBases = std::function<Result<double>(const BasePictures&)>;

// The direction in which base pictures pay, if in any: by a look at few parts at a low effort. Baked textures,
// which gain 0.2 %, are not to pay for more, and mostly gain nothing in the first part. `cost_in_parts`: of the
// first 1 or 2, those that tell most first.
Result<BasePictures> paying_direction(std::uint8_t margin,
                                      const std::function<CostOfBases(std::size_t)>& cost_in_parts);

// Encodes the tiles of the sample that took most bytes again: with base pictures in both directions, and
// with margins where these pay. What costs least, error and bits together, is chosen. `plain` is a pass
// over the sample without any. Copies beside base pictures are not smoothed.
Result<BasePictures> choose_base_pictures(const EncodePlan& plan, const Sample& sample,
                                          const PassResult& plain);

} // namespace tessera
