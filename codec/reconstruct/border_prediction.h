// Predicts a block of a picture from the texels above it and to its left (FORMAT.md 4.6).
#pragma once

#include "format/tile/border_mode.h"
#include "format/tile/limits.h"

#include <array>
#include <cstdint>
#include <span>

namespace tessera {

// How many texels of a block's border have been decoded, from the block's upper left corner on:
// above the block to the right, and to its left downwards. It is the same in all planes.
struct BorderReach {
    int top = 0, left = 0;
};
BorderReach border_reach(const Block& block, const BlockShape& picture, const DecodedRegion& done);

// The decoded texels beside a block of a picture, in one plane. Reading them once serves all modes.
class BlockBorder {
public:
    // `plane` is a plane of the picture, `reach` the block's border_reach(). Precondition: the block
    // lies in the picture.
    BlockBorder(const Block& block, const BlockShape& picture, BorderReach reach,
                std::span<const std::int32_t> plane);

    // Writes the prediction to `out`, row by row. Preconditions: mode > 0, and `out` has room.
    void predict(BorderMode mode, std::int32_t* out) const;

private:
    // The texels along one side of the block, from its upper left corner on.
    class Side {
    public:
        void begin(int length) { length_ = length; }
        // Takes `count` texels, `step` apart.
        void read(const std::int32_t* from, int step, int count);
        void extend(); // repeats the last texel to the end
        void fill(std::int32_t value);
        std::int32_t operator[](int i) const { return texel_[static_cast<std::size_t>(i)]; }
        const std::int32_t* data() const { return texel_.data(); }

    private:
        int count_ = 0, length_ = 0;
        std::array<std::int32_t, 2 * max_block_side> texel_;
    };

    void complete(std::int32_t corner);
    std::int32_t mean() const;
    void directional(BorderMode mode, const Side& along, const Side& other, int n, int depth,
                     bool sideways, std::int32_t* out) const;

    const int nu_, nv_, length_;
    bool has_top_, has_left_;
    std::int32_t corner_ = 0;
    Side top_, left_;
};

} // namespace tessera
