// The hot loops of decoding, compiled once per instruction set from codec/kernels/kernels.inl and picked
// once per process. Every path gives the same bits: sums of integers are exact modulo 2^32.
#pragma once

#include "format/tile/colour_rotation.h"
#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

// Y, Co, Cg of a tile without the background's share, in sixteenths of a code, in the order (t, s)
// image, (v, u) texel; the background's share in codes.
struct PlaneSet {
    const std::int32_t* plane[3];
    std::int32_t background[3];
};

// A filter that copies go through (FORMAT.md 4.6): f + 2 g, plus 4 for smooth ones; and how many bits
// its sums lie above the values.
constexpr int copy_filter(bool smooth, int half_u, int half_v) {
    return (smooth ? 4 : 0) + 2 * (half_v & 1) + (half_u & 1);
}
constexpr int copy_shift(bool smooth) {
    return smooth ? 4 : 2;
}

// Where rows x n values go, rows `stride` apart: each is added to the one of `add`, where there is one, after
// that is rounded as rounded() does by add_shift, and clamped to -limit .. limit - 1.
struct RowsTarget {
    std::int32_t* out;
    int stride, rows, n;
    std::int32_t limit;
    const std::int32_t* add = nullptr;
    int add_stride = 0, add_shift = 0;
};
// Where a block of sides n goes in a plane: what lies between rows, views along s and views along t.
// Clamped likewise.
struct BlockTarget {
    std::int32_t* out;
    int n[4], row, s, t;
    std::int32_t limit;
};
// Copies of one s from a base picture filtered along u, whose rows are n long and stand side by side. Copy i
// is of `page` values, goes to out + i * stride, in place of what is there or added to it, and comes from
// the rows from row[i] on, in phase[i] of base_filter.
struct BaseCopies {
    std::int32_t* out;
    int stride, page, n, count;
    const std::int16_t* row;
    const std::uint8_t* phase;
    int add_shift; // what is there is rounded by this and added; nothing_there: it is not
    static constexpr int nothing_there = -1;
};
constexpr std::int32_t no_limit = 1 << 30; // above all that kernels give

// The filter of FORMAT.md 4.7 for one plane; four taps a ring.
struct FilterTaps {
    std::array<std::int32_t, filter_rings> strength;
    std::array<std::uint32_t, filter_rings> slope;
};

// Rows of a view, bit v for row v.
using RowSet = std::uint64_t;
static_assert(max_tile_side <= 64);

// A view of a plane as the filter reads it: rows x n values, rows `stride` apart; from: where the
// neighbours of its first value stand, ring after ring. Rows whose bit in `skip` is set stay as they are.
template <class Value> struct FilterView {
    const Value* centre;
    const Value* from[filter_taps];
    int stride, rows, n;
    RowSet skip;
};

// Where `rows` rows of n values go, `stride` apart; filter_margin values on either side repeat their ends.
template <class Value> struct PaddedRows {
    Value* out;
    int stride, rows, n;
};

struct Kernels {
    const char* name;

    // One inverse DCT pass along the innermost axis (FORMAT.md 4.3), for each of `rows` rows:
    //   out[x] = round(sum over k < support of basis(n)[k][x] * in[k] / 2^15)
    // in: rows x support; out: rows x n; both contiguous.
    void (*inverse_rows)(const std::int32_t* in, std::int32_t* out, int rows, int support, int n);
    // The same along an outer axis; in: support x inner, out: n x inner.
    void (*inverse_planes)(const std::int32_t* in, std::int32_t* out, int support, int n,
                           int inner);

    // Coefficients of three planes from rotated axes back to Y, Co, Cg (FORMAT.md 4.4), `count` of each.
    void (*unrotate)(std::int32_t* const planes[3], int count, const RotationMatrix& matrix);

    // Target = floor((in + 2^(shift - 1)) / 2^shift), or `in` for shift 0; `in` is dense and may be `out`.
    void (*put_block)(const std::int32_t* in, int shift, const BlockTarget& to);

    // sums[i] += C of FORMAT.md 4.6 from rows j - 1, j, j + 1. Smooth filters read texels -1..n of
    // them, plain ones 0..n, and neither a row that its filter does without.
    void (*add_copies)(const std::int32_t* const rows[3], int filter, int n, std::int32_t* sums);
    // Target = the predictions that these sums make, from rows that lie `stride` apart. Reads one texel
    // more on each side where the filter is smooth, one behind each row and a row below where it is not.
    void (*copy_rows)(const std::int32_t* from, int stride, int filter, const RowsTarget& to);

    // Copies from a base picture (FORMAT.md 4.6). Along u, out[r][i] is R of row r, n of them side by side,
    // in a phase of base_filter: from texels -2 .. n + 2 of rows that lie `stride` apart.
    void (*base_along_u)(const std::int32_t* from, int stride, int phase, int rows, int n,
                         std::int32_t* out);
    // And along v, where row[i] is the first of those that are summed.
    void (*base_along_v)(const std::int32_t* from, const BaseCopies& to);

    // Planes of `images` (s, t) pairs times `texels` (u, v) places -> 8-bit RGB with the pairs
    // fastest: colour transform, clamp and transposition in one (FORMAT.md 4.5).
    void (*store_ycocg8)(const PlaneSet& in, int texels, int images, unsigned char* out);

    // And back, in sixteenths, of any RGB; less the background. Only encoders need it.
    void (*load_ycocg8)(const unsigned char* in, int texels, int images,
                        const std::int32_t background[3], std::int32_t* const plane[3]);

    // Rows of a view, dense, as the filter reads them: within -limit .. limit - 1 and between margins.
    // Returns the rows that are all 0. Up to 15 past a row's margin may be written.
    RowSet (*pad_rows)(const std::int32_t* values, std::int32_t limit,
                       const PaddedRows<std::int16_t>& to);
    RowSet (*pad_wide_rows)(const std::int32_t* values, std::int32_t limit,
                            const PaddedRows<std::int32_t>& to);
    // out = the filtered values of a view, dense; of unorm8 and, in the second, half16. Values are within
    // value_limit; up to 15 past a row are read and have no effect.
    void (*filter_view)(const FilterView<std::int16_t>& in, const FilterTaps& taps,
                        std::int32_t* out);
    void (*filter_wide_view)(const FilterView<std::int32_t>& in, const FilterTaps& taps,
                             std::int32_t* out);
};

// The paths: portable loops; vectors of 128 bits as the compiler makes them of any instruction set (NEON,
// WebAssembly, SSE2); AVX2.
enum class KernelPath { scalar, vector, avx2 };
// The one in use: the best this CPU has, or the one that the environment variable TESSERA_SIMD names
// ("scalar", "vector", "avx2").
KernelPath kernel_path();
const Kernels& kernels();

extern const Kernels kernels_scalar, kernels_vector;
extern const Kernels kernels_avx2; // only where avx2_available()
bool avx2_available();

} // namespace tessera
