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
    bool is_predicted = false;               // copies or has a border mode
    int fineness = 0; // k: steps are 2^(-k / 2) times the file's, as those of base pictures
    BlockColour colour;
};

// How many coefficients of a block's scan order an encoder may code: the longest codable length
// with which all planes together stay within a segment's work.
int length_limit(int planes, int scan_length);

// How many times smaller the steps of blocks of this fineness are.
inline float times_finer(int fineness) {
    return std::exp2(0.5f * static_cast<float>(fineness));
}

// How luma predicts the two differences of colour.
struct LumaFit {
    BlockColour colour; // the shares that leave the least
    float energy = 0;   // of the decoded luma
    std::array<float, 2> product{}, squared_inverse_step{};

    // The energy that these shares predict, in squared steps.
    float gain(const BlockColour& shares) const;
};

// Holds scratch memory: one per thread.
class BlockQuantizer {
public:
    // `coding` and `costs` outlive this.
    BlockQuantizer(const TileCoding& coding, const BitCosts& costs,
                   const QuantizerOptions& options);

    // The cost of a block relative to a block of zeros, in squared steps.
    struct Cost {
        float luma = 0; // of the first plane
        float all = 0;
    };
    // Appends the block's colour, planes and levels to `out`, but not the block itself.
    Cost quantize(const BlockCoefficients& block, TileLevels& out);
    // The same in two steps: appends the first plane, and returns its cost; then appends the others
    // and the colour. The first plane is at index `luma`, and must be the last one in `out`.
    float quantize_luma(const BlockCoefficients& block, TileLevels& out);
    Cost quantize_others(const BlockCoefficients& block, std::size_t luma, float luma_cost,
                         TileLevels& out);
    // The same as quantize() for a block whose first plane is already in `out`, at index `luma`; it
    // is appended again.
    Cost quantize_chroma(const BlockCoefficients& block, std::size_t luma, float luma_cost,
                         TileLevels& out);
    // How much of the decoded luma is in Co and Cg, by least squares. `tile` has the levels of the
    // block from `first_plane` on.
    LumaFit fit_chroma(const BlockCoefficients& block, const TileLevels& tile,
                       std::size_t first_plane);
    // Subtracts these shares of the decoded luma from Co and Cg.
    void predict_chroma(const BlockCoefficients& block, const BlockColour& colour,
                        const TileLevels& tile, std::size_t first_plane, BlockCoefficients& out);
    // The cost of a block of zeros.
    float energy(const BlockCoefficients& block) const;

private:
    float inverse_step(const BlockCoefficients& block, int plane) const {
        const float inverse =
            block.colour.is_rotated() && plane < 3 ? inverse_rotated_step_ : inverse_step_[plane];
        return inverse * times_finer(block.fineness);
    }
    float quantize_plane(const BlockCoefficients& block, int plane, int first_token,
                         std::size_t first_plane, TileLevels& out);
    void take_block(const BlockCoefficients& from, BlockCoefficients& to) const;
    void decode_luma(const BlockCoefficients& block, const TileLevels& tile,
                     std::size_t first_plane);
    void find_crosses(const TileLevels& out, std::size_t first_plane, int end);

    const TileCoding& coding_;
    const BitCosts& costs_;
    const QuantizerOptions options_;
    std::array<float, max_planes> inverse_step_{};
    float inverse_rotated_step_ = 1;
    std::array<std::array<float, 2>, plane_classes> offset_{};
    RecentShapes shapes_;
    std::vector<std::pair<std::uint32_t, float>> luma_; // decoded coefficients: place, value
    std::vector<float> amplitude_;
    std::vector<std::uint8_t> cross_;
    std::vector<NonZero> levels_;
    TrellisPaths paths_;
};

} // namespace tessera
