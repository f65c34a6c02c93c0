// Groups of places that share directional light.
#pragma once

#include "corpus/layers/layer_texture.h"
#include "corpus/model_surface/model_places.h"

#include <algorithm>

namespace tessera::corpus {

// A layer with a group for each texel, all of them masked, in tiles that suit so many directions.
inline LayerTexture make_cell_layer(LayerRole role, const Texels2& cells,
                                    const Texels2& directions) {
    const auto [columns, rows] = directions;
    LayerTexture texture = make_layer(role, {cells[0], cells[1], columns, rows}, 3);
    texture.mask_desc.size = {cells[0], cells[1], 1, 1};
    texture.mask.assign(texel_count(texture.mask_desc.size), std::byte{0});
    texture.tile = {16, 16, std::min(columns, 32u), std::min(rows, 32u)};
    return texture;
}

// The groups of `step` places a side that cover `all` places.
inline Texels2 cells_of_places(const Texels2& all, std::uint32_t step) {
    return {(all[0] + step - 1) / step, (all[1] + step - 1) / step};
}

// The places of group (u, v) for which keep(u of the place, v of the place) is true.
template <class Keep>
std::vector<Texels2> places_of_cell(std::uint32_t u, std::uint32_t v, std::uint32_t step,
                                    const Texels2& all, const Keep& keep) {
    std::vector<Texels2> places;
    for (std::uint32_t y = v * step; y < std::min((v + 1) * step, all[1]); ++y)
        for (std::uint32_t x = u * step; x < std::min((u + 1) * step, all[0]); ++x)
            if (keep(x, y))
                places.push_back({x, y});
    return places;
}

// One of the places, by a random number in 0..1.
inline const Texels2& chosen_place(const std::vector<Texels2>& places, double random) {
    return places[std::min(static_cast<std::size_t>(random * static_cast<double>(places.size())),
                           places.size() - 1)];
}

// The direction of the view whose mirrored direction is (s, t), bent to the front of the surface.
inline glm::dvec3 mirrored_view(const SurfaceFrame& frame, double s, double t) {
    constexpr double least_cosine = 0.02;
    const glm::dvec3 n = frame.ez;
    glm::dvec3 view = octahedral_direction(AngularMap::octahedral_mirrored, frame, s, t);
    view -= 2.0 * std::min(glm::dot(view, n), 0.0) * n;
    return glm::normalize(view + std::max(least_cosine - glm::dot(view, n), 0.0) * n);
}

} // namespace tessera::corpus
