// A tile's source as the encoder transforms it: planes of floats, in codes.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_planes.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "format/tile/block_transform.h"
#include "format/tile/prediction.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Holds scratch memory: one per thread.
class SourceTile {
public:
    // `coding` outlives this.
    explicit SourceTile(const TileCoding& coding)
        : coding_(&coding), codes_(1.0f / static_cast<float>(1 << value_bits(coding.type))) {}

    void set(const TilePlanes& planes);
    // The same for texels that all matter, without planes in between. False if there is no kernel
    // for such texels.
    bool set_texels(std::span<const std::byte> texels, const ColourCoding& colour,
                    const BlockShape& shape);

    const BlockShape& shape() const { return shape_; }
    const std::vector<float>& plane(int plane) const { return planes_[plane]; }
    float codes() const { return codes_; } // that one unit of TilePlanes stands for

    // Writes one plane of a block, less what it copies of `reconstructed`, dense in block order.
    void difference(const Block& block, const BlockPrediction& prediction, int plane,
                    const TilePlanes& reconstructed, float* to);
    // The coefficients of that, in the first `planes` planes.
    void transform(const Block& block, const BlockPrediction& prediction,
                   const TilePlanes& reconstructed, BlockCoefficients& out, int planes);

    // Writes one plane of a block of a picture, less `predicted` unless that is null, row by row.
    void subtract(const Block& block, int plane, const std::int32_t* predicted, float* to) const;
    // The coefficients of such a difference, which must not be in `out`. Returns whether they are
    // all 0.
    bool transform_plane(const BlockShape& shape, AxisTransforms axes, const float* difference,
                         std::vector<float>& out);

private:
    const TileCoding* coding_;
    float codes_;
    BlockShape shape_;
    std::array<std::vector<float>, max_planes> planes_;
    BlockShape zero_shape_; // of the tile that zero_squares_ describes; one texel has no squares
    std::vector<std::uint8_t> zero_squares_; // Ycocg8Planes::is_zero of planes_
    std::vector<std::int32_t> predicted_;
    std::vector<float> difference_, scratch_;
};

} // namespace tessera
