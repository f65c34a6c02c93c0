// What differs between photographs although it should not: exposure, pose, and whole pictures.
#pragma once

#include "corpus/fit/least_squares.h"

#include <glm/vec2.hpp>

namespace tessera::corpus {

// How one photograph differs from what the fitted fields predict.
struct PhotoDifference {
    double error = 0; // root mean square over the pixels that count, all channels
    // What its colours have to be divided by, at most a factor of 2.
    std::array<double, 3> gain{1.0, 1.0, 1.0};
    glm::dvec2 shift{0.0}; // by which it shows the mesh too far to the right and down, in pixels
};

// Of each photograph. `predicted` has the colours of all pixels. Pixels count by their weights.
std::vector<PhotoDifference> photo_differences(const PhotoSamples& samples,
                                               const PixelColours& predicted);

// Weighs pixels down whose errors are far larger than those of most: people who walk by, places where
// the mesh is wrong. Multiplies their weights by the robust function of Geman and McClure (1987),
// with a scale of `times` the root mean square of all errors.
void weigh_outliers(PhotoSamples& samples, const PixelColours& predicted, double times);

} // namespace tessera::corpus
