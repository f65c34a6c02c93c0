#pragma once

#include "corpus/layers/place_light.h"

#include <span>

namespace tessera::corpus {

// How much of an error of the stored visibility a display shows: the root of the mean square over
// places, views and channels, of the errors of all lights together. Rough surfaces that mirror
// little show little. The lights are multiplied by `exposure`.
double shown_error_of_visibility(const ModelPlaces& places, const PlaceLight& light,
                                 std::span<const DistantLight> lights, double exposure);

} // namespace tessera::corpus
