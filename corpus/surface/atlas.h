// Charts: where the patches of a surface lie in the atlas.
#pragma once

#include "corpus/surface/patch.h"

#include <glm/vec2.hpp>
#include <span>

namespace tessera::corpus {

using Texels2 = std::array<std::uint32_t, 2>; // along u and v

// Texels around the patch, on each side, that continue it: bilinear taps at its border, wherever the mesh's
// quantisation moves that, see nothing else.
constexpr std::uint32_t gutter = 1;

struct Chart {
    std::size_t object = 0; // of the scene
    Part part;
    Texels2 begin{0,
                  0}; // multiples of the tile's sides: what straddles tiles costs twice the bytes
    Texels2 extent{0, 0}; // with its gutters

    bool contains(const glm::dvec2& texel) const { // in texels from the atlas' corner
        for (glm::length_t a = 0; a < 2; ++a) {
            const auto i = static_cast<std::size_t>(a);
            if (texel[a] < begin[i] || texel[a] > begin[i] + extent[i])
                return false;
        }
        return true;
    }
};

struct AtlasOptions {
    double density = 32;  // texels a world unit for an observer `distance` from the origin
    double distance = 10; // of the paper's observers
    Texels2 tile{32, 32};
};

struct Atlas {
    std::vector<Chart> charts; // one a patch
    Texels2 size{0, 0};        // multiples of the tile's sides
};

// Errors: unsupported, charts too large for an atlas.
Result<Atlas> make_atlas(std::span<const Patch> patches, const AtlasOptions& options);

} // namespace tessera::corpus
