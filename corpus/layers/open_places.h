// The parts of texels that lie outside all bodies.
#pragma once

#include "corpus/layers/rows.h"
#include "corpus/model_surface/model_places.h"

namespace tessera::corpus {

// Where bodies intersect, a part of the surface lies inside one of them. No observer sees it, and the
// light there is wrong: it passes backs. Immutable and thread-safe. Memory: 2 bytes per texel.
class OpenPlaces {
public:
    // Errors: those of for_rows().
    static Result<OpenPlaces> make(const ModelPlaces& places, const BakeRun& run);

    // Whether the texel shows a place that an observer may see, or is beside one.
    bool matters(std::uint32_t u, std::uint32_t v) const { return parts_[index(u, v)] != hidden; }
    // A place of the texel, outside bodies if there is one, as an offset from its centre in texels.
    // `random` is in 0..1.
    glm::dvec2 offset(std::uint32_t u, std::uint32_t v, const glm::dvec2& random) const;
    // That place, with the normal of the mesh instead of a bumped one.
    ModelSurfacePlace smooth_place(const ModelPlaces& places, std::uint32_t u, std::uint32_t v,
                                   const glm::dvec2& random) const {
        ModelSurfacePlace place = places.place(u, v, offset(u, v, random));
        place.point.normal = place.frame.ez;
        return place;
    }

private:
    static constexpr std::uint32_t side = 4; // parts along a side of a texel
    static constexpr std::uint16_t hidden = 0, all = 0xFFFF;

    std::size_t index(std::uint32_t u, std::uint32_t v) const {
        return std::size_t{v} * size_[0] + u;
    }
    bool is_near_hidden(std::uint32_t u, std::uint32_t v) const;

    Texels2 size_{0, 0};
    std::vector<std::uint16_t> parts_; // a bit for each part that is open
};

} // namespace tessera::corpus
