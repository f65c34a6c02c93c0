// Predicts a block of a picture from the texels above it and to its left (FORMAT.md 4.6).
#pragma once

#include "format/tile/border_mode.h"
#include "format/tile/limits.h"

#include <array>
#include <cstdint>
#include <span>

namespace tessera {

// The decoded texels beside a block of a picture, in one plane. Reading them once serves all modes.
class BlockBorder {
public:
    // `plane` is a plane of the picture, `done` what has been decoded of it. Precondition: the block
    // lies in the picture.
    BlockBorder(const Block& block, const BlockShape& picture, std::span<const std::int32_t> plane,
                const DecodedRegion& done);

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
    void planar(std::int32_t* out) const;
    void directional(BorderMode mode, const Side& along, const Side& other, int n, int depth,
                     bool sideways, std::int32_t* out) const;

    const int nu_, nv_, length_;
    bool has_top_, has_left_;
    std::int32_t corner_ = 0;
    Side top_, left_;
};

// Writes the prediction of one plane of `block` to `out`, row by row. `plane` is a plane of the
// picture, `done` what has been decoded of it. Preconditions: mode > 0, the block lies in the
// picture, and `out` has room for it.
void predict_from_border(const Block& block, BorderMode mode, const BlockShape& picture,
                         std::span<const std::int32_t> plane, const DecodedRegion& done,
                         std::int32_t* out);

} // namespace tessera
