// Detects parallax: whether a texture's views show the same objects from positions side by side, as
// a grid of cameras does.
#pragma once

#include "codec/tile/tile_texels.h"
#include "format/levels.h"
#include "format/texture.h"
#include "format/tile/base_picture.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace tessera {

// A part of a texture in which trials look for what moves from view to view: the codes of one
// channel, the green one of colours.
class MotionPatch {
public:
    using Place = std::array<int, 4>; // by axis

    MotionPatch(const Box4& box, const TileTexels& tile, const TextureDesc& desc);
    int side(Axis axis) const { return static_cast<int>(extent_[axis]); }
    int at(const Place& place) const { return codes_[index(place)]; }
    bool is_free(const Place& place) const { return tessera::is_free(matters_, index(place)); }

private:
    std::size_t index(const Place& place) const {
        Extent4 at;
        std::ranges::copy(place, at.begin());
        return Box4::whole(extent_).index_of(at);
    }

    Extent4 extent_;
    std::vector<std::byte> matters_; // as TileTexels has it
    std::vector<int> codes_;
};

// The base pictures, without a margin, that follow the parallax of views with this alignment; off
// if the patches show too little parallax.
BasePictures parallax_in(std::span<const MotionPatch> patches, ViewAlignment alignment);

} // namespace tessera
