// The few coefficients of a block that are not 0, and their way through the inverse transform
// (FORMAT.md 4.3).
//
// Frequencies of views, pairs (s, t), of which no plane has a coefficient give nothing before the pass along
// s. The others are *columns*: the passes along u and v run over those alone.
#pragma once

#include "codec/tile/tile_levels.h"
#include "format/tile/dequantizer.h"
#include "format/tile/limits.h"
#include "format/tile/scan_order.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tessera {

// Of one block at a time: begin(), add() for each plane that goes through together, then the rest.
class CoefficientBox {
public:
    CoefficientBox() { column_of_.fill(-1); }

    void begin();
    void add(std::span<const NonZero> levels, const ScanOrder& order);

    // Whether no coefficient but the first is there.
    bool is_constant() const { return support_ == Support{1, 1, 1, 1}; }
    // Coefficients that dequantize() fills.
    int size() const { return support_[0] * support_[1] * count_; }
    // Values of a plane's coefficients, in an order that transform() knows. `box` gets room for all passes.
    void dequantize(std::span<const NonZero> levels, const ScanOrder& order, const ScaleSet& scales,
                    const ReconstructionOffsets& offsets, std::vector<std::int32_t>& box) const;
    // `a` in, out: dense in block order. `b`: scratch.
    void transform(const BlockShape& shape, std::vector<std::int32_t>& a,
                   std::vector<std::int32_t>& b) const;

private:
    using Support = std::array<std::uint8_t, 4>;
    static constexpr int views = max_frequencies * max_frequencies;

    // Vectors are filled by columns side by side where there are enough, else by rows.
    bool columns_run_fastest() const;
    static int view_of(const ScanEntry& entry) { return entry.k[3] * max_frequencies + entry.k[2]; }
    void spread_columns(const std::int32_t* columns, int page, std::int32_t* out) const;

    Support support_{};                                // one more than the largest frequency
    std::array<std::uint8_t, max_frequencies> of_t_{}; // the same along s, at each t; 0: no column
    int count_ = 0;                                    // of columns
    std::array<std::int16_t, views> column_of_;        // -1: none
    std::array<std::int16_t, views> view_;             // of each column
};

} // namespace tessera
