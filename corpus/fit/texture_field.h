// A texture of floats on the atlas that is fitted to photographs.
#pragma once

#include "corpus/fit/photo_samples.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tessera::corpus {

// RGB values of places and directions. The fit keeps neighbours alike: the sum of the squares of
// their differences costs as much as an error of the photographs. A place that shows no chart has no
// neighbours.
struct TextureField {
    std::uint32_t width = 1, height = 1; // places along u and v
    std::uint32_t directions = 1;        // along s and along t, in the mirrored octahedral map
    std::vector<std::uint32_t> charts;   // of each place, u fastest; 0: it shows none
    double smooth_places = 0;            // cost of neighbouring places of a chart
    double smooth_directions = 0;        // cost of neighbouring directions
    double shrink = 0;                   // cost of values other than 0
    // 3 per texel: s fastest, then t, u, v.
    std::vector<float> values;

    std::size_t places() const { return std::size_t{width} * height; }
    std::size_t texels_per_place() const { return std::size_t{directions} * directions; }
    // Sets all values to 0.
    void clear() { values.assign(3 * places() * texels_per_place(), 0.0f); }
};

// The texels that a sample shows: the same as mesh_footprint(), in single precision.
struct FieldTaps {
    std::array<std::uint32_t, 16> first; // index of the texel's first value
    std::array<float, 16> weight;
    unsigned count = 0;
};
FieldTaps taps(const TextureField& field, const PhotoSample& sample);

// Adds to `out` the gradient of the costs of neighbours at `values`, which have the layout of
// field.values. The gradient is linear in the values.
void add_smoothness(const TextureField& field, const std::vector<float>& values,
                    std::vector<float>& out);

} // namespace tessera::corpus
