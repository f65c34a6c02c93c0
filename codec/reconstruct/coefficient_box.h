// The non-zero coefficients of a block, of which there are few, and their inverse transform
// (FORMAT.md 4.3).
//
// The pairs (s, t) of frequencies at which some plane has a coefficient are called *columns*. The
// passes along u and v process only these, because everything else is zero until the pass along s.
#pragma once

#include "codec/tile/tile_levels.h"
#include "format/tile/block_transform.h"
#include "format/tile/dequantizer.h"
#include "format/tile/limits.h"
#include "format/tile/scan_order.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Handles one block at a time: begin(), add() for each plane transformed together, then the rest.
class CoefficientBox {
public:
    CoefficientBox() { column_of_.fill(-1); }

    void begin();
    void add(std::span<const NonZero> levels, const ScanOrder& order);

    // Whether at most the DC coefficient is not 0.
    bool is_constant() const {
        return support_[0] + support_[1] + support_[2] + support_[3] == 4; // each is at least 1
    }
    // How many coefficients dequantize() fills.
    int size() const { return support_[0] * support_[1] * count_; }
    // Where dequantize() puts the DC coefficient, or -1 if it leaves out its column, where all
    // coefficients are 0.
    int dc() const {
        const int column = column_of_[0];
        return column < 0 || columns_run_fastest() ? column : column * support_[1];
    }
    // Dequantises a plane into `box` in the order that transform() expects, with room for all
    // passes. Blocks with other transforms than cosines have one view.
    void dequantize(std::span<const NonZero> levels, const ScanOrder& order, const ScaleSet& scales,
                    const ReconstructionOffsets& offsets, AxisTransforms axes,
                    std::vector<std::int32_t>& box) const;
    // Transforms coefficients in `a` to values in `a`, dense in block order. `b` is scratch memory.
    void transform(const BlockShape& shape, AxisTransforms axes, std::vector<std::int32_t>& a,
                   std::vector<std::int32_t>& b) const;

private:
    using Support = std::array<std::uint8_t, 4>;
    static constexpr int views = max_frequencies * max_frequencies;

    void add_picture(std::span<const NonZero> levels, const ScanOrder& order);
    void dequantize_picture(std::span<const NonZero> levels, const ScanOrder& order,
                            const ScaleSet& scales, const ReconstructionOffsets& offsets,
                            AxisTransforms axes, std::vector<std::int32_t>& box) const;
    void keep_rows(const std::int32_t* columns, int nu, std::int32_t* out) const;
    // Small blocks have the support of all frequencies along u and v, unless only DC is not 0:
    // kernels have faster loops for these.
    static bool is_small(const BlockShape& shape);
    // Whether columns are adjacent in memory. With few columns, rows fill vectors better.
    bool columns_run_fastest() const;
    static int view_of(const ScanEntry& entry) { return entry.k[3] * max_frequencies + entry.k[2]; }
    void spread_columns(const std::int32_t* columns, int page, std::int32_t* out) const;

    Support support_{}; // along each axis, more than the largest frequency
    std::array<std::uint8_t, max_frequencies> of_t_{}; // the same along s for each t; 0: no column
    int count_ = 0;                                    // number of columns
    std::array<std::int16_t, views> column_of_;        // of each pair; -1: none
    std::array<std::int16_t, views> view_;             // the pair of each column
};

} // namespace tessera
