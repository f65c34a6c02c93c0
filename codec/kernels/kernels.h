// The hot loops of decoding. kernels.inl is compiled once per instruction set, and each process
// uses one of the results. All give the same bits because they sum integers modulo 2^32.
#pragma once

#include "format/tile/colour_rotation.h"
#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

// The planes Y, Co, Cg of a tile minus the background, in sixteenths of a code, and the background
// in codes. The order is t, s, v, u with u fastest.
struct PlaneSet {
    const std::int32_t* plane[3];
    std::int32_t background[3];
};

// The number of the filter that a copy goes through (FORMAT.md 4.6): 1 for a half-texel
// displacement along u, plus 2 for one along v, plus 4 if copies are smoothed.
constexpr int copy_filter(bool smooth, int half_u, int half_v) {
    return (smooth ? 4 : 0) + 2 * (half_v & 1) + (half_u & 1);
}
// Fraction bits of that filter's sums.
constexpr int copy_shift(bool smooth) {
    return smooth ? 4 : 2;
}

// Where rows x n values go; rows lie `stride` apart. If `add` is set, its value is rounded by
// add_shift as in rounded_value() and added. The result is clamped to -limit .. limit - 1.
struct RowsTarget {
    std::int32_t* out;
    int stride, rows, n;
    std::int32_t limit;
    const std::int32_t* add = nullptr;
    int add_stride = 0, add_shift = 0;
};
// Where a block of sides n goes in a plane: the distances between rows, views along s and views
// along t. Values are clamped to -limit .. limit - 1.
struct BlockTarget {
    std::int32_t* out;
    int n[4], row, s, t;
    std::int32_t limit;
};
// Copies for one s from a base picture that has already been filtered along u; its rows are n long
// and contiguous. Copy i has `page` values and goes to out + i * stride. It begins at row row[i]
// and is filtered along v with base_filter[phase[i]].
struct BaseCopies {
    std::int32_t* out;
    int stride, page, n, count;
    const std::int16_t* row;
    const std::uint8_t* phase;
    int add_shift; // rounds what is in `out` before adding to it; nothing_there: overwrites `out`
    static constexpr int nothing_there = -1;
};
constexpr std::int32_t no_limit = 1 << 30; // above every value that kernels produce

// The border of a block of a picture as one line, to be continued into the block (FORMAT.md 4.6).
// line[0] is the corner, and line[i] texel i of the side that is continued, n of which touch the
// block; line[-i] is a texel of the other side. Row y = 0 .. depth - 1 of the block, counted from
// that side, moves by `slope` / 32 texels for each row. Up to read_behind_border values past the last
// one are read but have no effect.
struct BorderLine {
    const std::int32_t* line;
    int slope, n, depth;
};
constexpr int read_behind_border = 8;

// The filter of FORMAT.md 4.7 for one plane. Each ring has four taps.
struct FilterTaps {
    std::array<std::int32_t, filter_rings> strength;
    std::array<std::uint32_t, filter_rings> slope;
};

// A set of rows of a view: bit v stands for row v.
using RowSet = std::uint64_t;

// A view of a plane as the filter reads it: rows x n values, rows `stride` apart. from[i] points at
// neighbour i of the first value, ring by ring. Rows whose bit is set in `skip` stay as they are.
template <class Value> struct FilterView {
    const Value* centre;
    const Value* from[filter_taps];
    int stride, rows, n;
    RowSet skip;
};

// Where rows x n values go, `stride` apart. filter_margin values on both sides repeat the ends.
template <class Value> struct PaddedRows {
    Value* out;
    int stride, rows, n;
};

struct Kernels {
    const char* name;

    // One inverse DCT pass (FORMAT.md 4.3) along an axis that becomes the innermost one:
    //
    //   out[r][x] = round(sum over k < support of basis(n)[k][x] * in[k][r] / 2^15)
    //
    // in: support x rows. out: rows x n.
    void (*inverse_rows)(const std::int32_t* in, std::int32_t* out, int rows, int support, int n);
    // The same along an axis that stays the outer one. in: support x inner. out: n x inner.
    void (*inverse_planes)(const std::int32_t* in, std::int32_t* out, int support, int n,
                           int inner);

    // The same two passes with sine_basis(n), for n <= max_sine_side.
    void (*sine_rows)(const std::int32_t* in, std::int32_t* out, int rows, int support, int n);
    void (*sine_planes)(const std::int32_t* in, std::int32_t* out, int support, int n, int inner);

    // Rotates `count` coefficients of three planes back to Y, Co, Cg (FORMAT.md 4.4).
    void (*unrotate)(std::int32_t* const planes[3], int count, const RotationMatrix& matrix);

    // Adds to `count` coefficients of chroma the share of luma that predicts them (FORMAT.md 4.4).
    // `share` has rotation_bits fraction bits. |luma| is at most coefficient_limit.
    void (*add_luma)(const std::int32_t* luma, int count, std::int32_t share, std::int32_t* chroma);

    // Writes floor((in + 2^(shift - 1)) / 2^shift), or `in` for shift 0. `in` is dense.
    void (*put_block)(const std::int32_t* in, int shift, const BlockTarget& to);

    // sums[i] += C of FORMAT.md 4.6, computed from rows j - 1, j, j + 1. Smooth filters read texels
    // -1..n of them, the others 0..n. A row with no weights is not read.
    void (*add_copies)(const std::int32_t* const rows[3], int filter, int n, std::int32_t* sums);
    // Writes the predictions computed from these sums; rows of `from` lie `stride` apart. Reads a
    // row and a texel more on each side for smooth filters, and only below and after for others.
    void (*copy_rows)(const std::int32_t* from, int stride, int filter, const RowsTarget& to);

    // The first pass of copies from a base picture (FORMAT.md 4.6). out[r][i] is row r filtered
    // along u with base_filter[phase]; output rows are contiguous. Reads texels -2 .. n + 2 of each
    // row; input rows lie `stride` apart.
    void (*base_along_u)(const std::int32_t* from, int stride, int phase, int rows, int n,
                         std::int32_t* out);
    // The second pass, along v. row[i] is the first of the six rows that are summed.
    void (*base_along_v)(const std::int32_t* from, const BaseCopies& to);

    // Planes of `images` (s, t) pairs times `texels` (u, v) positions -> 8-bit RGB with the pairs
    // fastest. Undoes the colour transform, clamps and transposes (FORMAT.md 4.5).
    void (*store_ycocg8)(const PlaneSet& in, int texels, int images, unsigned char* out);

    // The inverse, for the encoder: any RGB to sixteenths of a code minus the background.
    void (*load_ycocg8)(const unsigned char* in, int texels, int images,
                        const std::int32_t background[3], std::int32_t* const plane[3]);

    // Continues the side above a block to depth x n texels in `out`, row by row, or the side to its
    // left to n x depth texels.
    void (*continue_top)(const BorderLine& from, std::int32_t* out);
    void (*continue_left)(const BorderLine& from, std::int32_t* out);

    // Fills a block of nu x nv texels with the plane between its borders (mode 2 of FORMAT.md 4.6).
    // `top` has nu + 1 texels, `left` nv + 1.
    void (*continue_both)(const std::int32_t* top, const std::int32_t* left, int nu, int nv,
                          std::int32_t* out);

    // Copies the dense rows of a view for the filter, clamped to -limit .. limit - 1, with margins.
    // Returns the rows that are all 0. May write 15 values past a row's margin.
    RowSet (*pad_rows)(const std::int32_t* values, std::int32_t limit,
                       const PaddedRows<std::int16_t>& to);
    RowSet (*pad_wide_rows)(const std::int32_t* values, std::int32_t limit,
                            const PaddedRows<std::int32_t>& to);
    // out = the filtered values of a view, dense. The first is for unorm8, the second for half16.
    // Values are within value_limit. Up to 15 values past a row are read but have no effect.
    void (*filter_view)(const FilterView<std::int16_t>& in, const FilterTaps& taps,
                        std::int32_t* out);
    void (*filter_wide_view)(const FilterView<std::int32_t>& in, const FilterTaps& taps,
                             std::int32_t* out);
};

// scalar: portable loops. vector: the compiler's generic 128-bit vectors (NEON, WebAssembly, SSE2).
// Decoding has no kernels for AVX-512 and uses those for AVX2.
enum class KernelPath { scalar, vector, avx2, avx512 };
// The path in use: the best that this CPU and build support, or a lesser one that the environment
// variable TESSERA_SIMD names.
KernelPath kernel_path();
const Kernels& kernels();

extern const Kernels kernels_scalar, kernels_vector;
extern const Kernels kernels_avx2; // may be used only if avx2_available()
bool avx2_available();
bool avx512_available();

} // namespace tessera
