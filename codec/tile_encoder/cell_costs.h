// Models of what blocks cost in bits and distortion, for a search that chooses no levels.
#pragma once

#include "codec/tile/tile_coding.h"
#include "codec/tile_encoder/block_quantizer.h"
#include "codec/tile_encoder/cell_grid.h"

#include <array>
#include <cstddef>
#include <map>
#include <vector>

namespace tessera {

// All costs are in squared steps. Holds scratch memory: one per thread.
class CellCosts {
public:
    // `coding` outlives this.
    CellCosts(const TileCoding& coding, const SearchOptions& options)
        : coding_(&coding), options_(options) {
        set_fineness(0);
    }

    // Steps are 2^(-k / 2) times the file's from now on, as for base pictures.
    void set_fineness(int k);
    int fineness() const { return fineness_; }
    float inverse_step(int plane) const { return inverse_step_[plane]; }

    // Coefficients of one block by plane, in the order of SearchKernels::forward_image.
    using Coefficients = std::array<std::vector<float>, max_planes>;

    static constexpr float block_overhead_bits = 3.0f; // not part of the costs below
    // Cost of the mean of a cell whose energy is that mean's.
    float mean_cost(float energy) const;
    // Cost of one plane of a block on the file's colour axes.
    float plane_cost(const Coefficients& block, const BlockShape& shape, int plane);
    // Cost of a block on the better colour axes. `energy`: all of the block's, needed where
    // forward_image leaves frequencies out.
    float block_cost(const Coefficients& block, const BlockShape& shape, float energy);
    // Cost of a block's full coefficients without the symbol of its colour.
    float estimate(const BlockCoefficients& block) {
        return estimate(block, 0, coding_->planes, 0);
    }
    // `cost` plus that of the planes from `first` to `end` - 1, summed in that order.
    float estimate(const BlockCoefficients& block, int first, int end, float cost);

private:
    // block_cost by the model alone.
    float modelled_cost(const Coefficients& block, const BlockShape& shape, float energy);
    // Cost of coding each coefficient, apart from its magnitude: in block order and in that of
    // forward_image.
    const std::vector<float>& dense_costs(const BlockShape& shape);
    const std::vector<float>& kept_costs(const BlockShape& shape);
    float cost_of(const float* x, const float* base, int count, float inverse_step,
                  CostSum* sum = nullptr) const;

    const TileCoding* coding_;
    SearchOptions options_;
    int fineness_ = 0;
    std::array<float, max_planes> inverse_step_{};
    float inverse_rotated_step_ = 1;
    std::vector<float> rotated_;
    std::map<BlockShape, std::vector<float>> dense_, kept_;
    // The entry of dense_ that was used last, as most blocks are estimated many times.
    BlockShape recent_shape_;
    const std::vector<float>* recent_ = nullptr;
};

} // namespace tessera
