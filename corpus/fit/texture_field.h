// A texture of floats on the atlas that is fitted to photographs.
#pragma once

#include "corpus/fit/photo_samples.h"
#include "format/metadata.h"

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace tessera::corpus {

// RGB values of places and directions. The fit keeps neighbours alike: the sum of the squares of
// their differences costs as much as an error of the photographs. A place that shows no chart has no
// neighbours.
struct TextureField {
    std::uint32_t width = 1, height = 1;           // places along u and v
    std::array<std::uint32_t, 2> directions{1, 1}; // along s and t
    // How s and t stand for directions: octahedral_mirrored on a mesh, hemisphere_alpha_beta on a
    // sphere, planar_views in a window.
    AngularMap map = AngularMap::octahedral_mirrored;
    // The frame of each place of a sphere, u fastest: ex, ey and ez. Set by make_sphere_field().
    std::vector<std::array<glm::vec3, 3>> frames;
    // Of each texel of a sphere, its neighbours of the next direction along s and along t, or
    // itself. They show the same place of the focus, see make_sphere_field().
    std::vector<std::array<std::uint32_t, 2>> next_directions;
    std::vector<std::uint32_t> charts; // of each place, u fastest; 0: it shows none
    double smooth_places = 0;          // cost of neighbouring places of a chart
    double smooth_directions = 0;      // cost of neighbouring directions
    double shrink = 0;                 // cost of values other than 0
    // 3 per texel: s fastest, then t, u, v.
    std::vector<float> values;

    std::size_t places() const { return std::size_t{width} * height; }
    std::size_t texels_per_place() const { return std::size_t{directions[0]} * directions[1]; }
    // Sets all values to 0.
    void clear() { values.assign(3 * places() * texels_per_place(), 0.0f); }
};

// A field on a sphere that is seen from outside, and one in a window, all 0. `focus` is the radius, as
// a share of the sphere's, of a sphere inside it which is near the object's surface: neighbouring
// directions are kept alike where they show the same place of that. 1: on the sphere itself.
TextureField make_sphere_field(std::uint32_t width, std::uint32_t height,
                               std::array<std::uint32_t, 2> directions, double focus);
TextureField make_window_field(std::uint32_t width, std::uint32_t height,
                               std::array<std::uint32_t, 2> directions);

// The texels that a sample shows, in single precision. They are those of mesh_footprint(), of
// sample_footprint(), or those of planar views that coincide in their window (FORMAT.md 5.3).
struct FieldTaps {
    std::array<std::uint32_t, 16> first; // index of the texel's first value
    std::array<float, 16> weight;
    unsigned count = 0;
};
FieldTaps taps(const TextureField& field, const PhotoSample& sample);

// What a sample at the centre of a texel shows: the inverse of taps().
PhotoSample centre_of_texel(const TextureField& field, std::size_t texel);

// Adds to `out` the gradient of the costs of neighbours at `values`, which have the layout of
// field.values. The gradient is linear in the values.
void add_smoothness(const TextureField& field, const std::vector<float>& values,
                    std::vector<float>& out);

} // namespace tessera::corpus
