// Parts of a texture in which trials look for what moves from view to view.
#pragma once

#include "codec/pass/encode_pass.h"
#include "format/texture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tessera {

// One channel of a patch, in codes: the green one where there are colours.
class MotionPatch {
public:
    using Place = std::array<int, 4>; // by axis

    MotionPatch(const Box4& box, const TileTexels& tile, const TextureDesc& desc);
    int side(Axis axis) const { return static_cast<int>(extent_[axis]); }
    int at(const Place& place) const { return codes_[index(place)]; }
    // Whether it does not matter.
    bool is_free(const Place& place) const { return tessera::is_free(matters_, index(place)); }

private:
    std::size_t index(const Place& place) const {
        const auto at = [&](Axis axis) { return static_cast<std::size_t>(place[axis]); };
        return ((at(axis_v) * extent_[axis_u] + at(axis_u)) * extent_[axis_t] + at(axis_t)) *
                   extent_[axis_s] +
               at(axis_s);
    }

    Extent4 extent_;
    std::vector<std::byte> matters_; // as TileTexels has it
    std::vector<int> codes_;
};

// Up to 16 patches of 64x64 places and 3x3 neighbouring views, spread over the texture. Errors: the source's.
Result<std::vector<MotionPatch>> read_motion_patches(const EncodePlan& plan);

} // namespace tessera
