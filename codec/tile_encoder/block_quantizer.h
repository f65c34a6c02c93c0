// Rate-distortion optimised quantisation of one block: its levels and coded lengths.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile/tile_levels.h"
#include "codec/tile_encoder/bit_costs.h"
#include "codec/tile_encoder/level_trellis.h"

#include <array>
#include <cmath>
#include <vector>

namespace tessera {

// Coefficients of one block, each plane dense in block order (t, s, v, u), orthonormal, in codes.
// The arrays may be longer than the block.
struct BlockCoefficients {
    BlockShape shape;
    std::array<std::vector<float>, max_planes> plane;
    std::array<bool, max_planes> is_blank{}; // planes known to be all 0
    bool copies = false;                     // the block copies; these are its difference
    int fineness = 0; // k: steps are 2^(-k / 2) times the file's, as those of base pictures
    int colour = 0;   // 0: the file's planes; otherwise the first three are on rotation colour - 1
};

// How many coefficients of a block's scan order an encoder may code: the longest codable length
// with which all planes together stay within a segment's work.
int length_limit(int planes, int scan_length);

// How many times smaller the steps of blocks of this fineness are.
inline float times_finer(int fineness) {
    return std::exp2(0.5f * static_cast<float>(fineness));
}

// Holds scratch memory: one per thread.
class BlockQuantizer {
public:
    // `coding` and `costs` outlive this.
    BlockQuantizer(const TileCoding& coding, const BitCosts& costs,
                   const QuantizerOptions& options);

    // Appends the block's colour, planes and levels to `out`, but not the block itself. Returns the
    // cost relative to a block of zeros, in squared steps.
    float quantize(const BlockCoefficients& block, TileLevels& out);
    // The cost of a block of zeros.
    float energy(const BlockCoefficients& block) const;

private:
    float inverse_step(const BlockCoefficients& block, int plane) const {
        const float inverse =
            block.colour != 0 && plane < 3 ? inverse_rotated_step_ : inverse_step_[plane];
        return inverse * times_finer(block.fineness);
    }
    float quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                         std::size_t first_plane, TileLevels& out);
    void find_crosses(const TileLevels& out, std::size_t first_plane, int end);

    const TileCoding& coding_;
    const BitCosts& costs_;
    const QuantizerOptions options_;
    std::array<float, max_planes> inverse_step_{};
    float inverse_rotated_step_ = 1;
    std::array<std::array<float, 2>, plane_classes> offset_{};
    RecentShapes shapes_;
    std::vector<float> amplitude_;
    std::vector<std::uint8_t> cross_;
    std::vector<NonZero> levels_;
    TrellisPaths paths_;
};

} // namespace tessera
