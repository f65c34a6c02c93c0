// Places the patches of a surface in an atlas, as charts.
#pragma once

#include "corpus/surface/patch.h"

#include <glm/vec2.hpp>
#include <span>

namespace tessera::corpus {

using Texels2 = std::array<std::uint32_t, 2>; // along u and v

// The texels on each side of a patch that continue it. Bilinear taps at the border then see no
// other chart, although quantisation moves the border of the mesh.
constexpr std::uint32_t gutter = 1;

struct Chart {
    std::size_t object = 0; // of the scene
    Part part;
    // A multiple of the tile's sides, because a chart that straddles tiles costs twice the bytes.
    Texels2 begin{0, 0};
    Texels2 extent{0, 0}; // with gutters

    bool contains(const glm::dvec2& texel) const { // in texels from the corner of the atlas
        for (glm::length_t a = 0; a < 2; ++a) {
            const auto i = static_cast<std::size_t>(a);
            if (texel[a] < begin[i] || texel[a] > begin[i] + extent[i])
                return false;
        }
        return true;
    }
};

struct AtlasOptions {
    double density = 32;  // texels per world unit for an observer `distance` from the origin
    double distance = 10; // of the observers in the paper
    Texels2 tile{32, 32};
    std::uint32_t side_step = 1; // the sides of the atlas are multiples of it, and of the tile's
};

struct Atlas {
    std::vector<Chart> charts; // one per patch
    Texels2 size{0, 0};
};

// Error: unsupported (charts too large for an atlas).
Result<Atlas> make_atlas(std::span<const Patch> patches, const AtlasOptions& options);

} // namespace tessera::corpus
