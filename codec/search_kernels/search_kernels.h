// The hot loops of the encoder's search, in which floats steer: compiled like those of codec/kernels, and
// picked with them. Every path gives the same bits: lanes are outputs or fixed partial sums, never a width
// that the compiler chooses, and contraction is off.
#pragma once

#include "codec/kernels/kernels.h"
#include "format/tile/code_tables.h"
#include "format/tile/dequantizer.h"
#include "format/tile/scan_order.h"

#include <cstddef>
#include <cstdint>

namespace tessera {

// What coding some coefficients would cost, and their energy, both in squared steps. Of the cost,
// what is due to those that are zeroed and to the bases of the others, and how many these are.
struct CostSum {
    float cost = 0, energy = 0;
    float zeroed = 0, bases = 0, coded = 0;
};

// Frequencies that forward_image computes along a side: long ones keep half, as a block that needs
// more is always cheaper when cut.
constexpr int forward_kept(int n) {
    return n >= 32 ? (n + 1) / 2 : n;
}
// Frequency at place i of a row: where the butterfly is used (4, 8, 16, 32, 64), the even ones first.
constexpr int forward_order(int n, int i) {
    const bool butterfly = n == 4 || n == 8 || n == 16 || n == 32 || n == 64;
    const int half = forward_kept(n) / 2;
    return !butterfly ? i : i < half ? 2 * i : 2 * (i - half) + 1;
}

// More than any path costs.
constexpr float unreachable_cost = 1e30f;

// Amplitudes of four coefficients on the paths of all states: what vectors of 32 bytes hold.
constexpr int trellis_rows_at_once = 4;
struct alignas(32) TrellisRows {
    std::uint8_t row[trellis_rows_at_once][quantiser_states];
};

// A plane's coefficients in scan order, and what their levels cost. Bits of a quantiser's zero flags are
// [row][is non-zero][class of the neighbours], those of its magnitudes [row][token][class].
struct TrellisTask {
    int count;
    const float* amplitude;          // in steps
    const std::uint16_t* neighbours; // ScanOrder's, scan_neighbours each
    const ScanContext* context;
    int first_class; // of the first coefficient, which has no neighbours
    const std::uint16_t* flag_row;
    const std::uint8_t* token_row;
    const float* end_cost; // what ending behind each coefficient costs; unreachable_cost: it cannot
    float zero_cost;       // what no levels at all cost
    const float* flags[quantisers];
    const float* tokens[quantisers];
    float lambda;
    float offsets[2]; // PlaneTask's
    // For each coefficient and state behind it: the best path's state before, its level, and its
    // amplitude for contexts.
    std::uint8_t* before;
    std::int32_t* level;
    TrellisRows* seen;
};

// Where the cheapest path ends.
struct TrellisEnd {
    float cost;
    int length, state;
};

// Where the texels of a cell lie in a plane of its tile: rows of `width` texels `row` apart, views `s` and `t`
// apart.
struct CellViews {
    int width, rows, ns, nt;
    int row, s, t;
};

// Of values that are matched: squared differences of two columns of 64 rows are less than 2^31.
constexpr int matching_limit = 2047;
// Kernels read that many behind the last of them.
constexpr std::size_t read_behind_matched = 3;

// What bytes differ by.
struct ByteErrors {
    std::uint64_t squared = 0; // summed
    std::uint32_t largest = 0;
};

// Rows that are summed at once, and how many of their differences 16 bits hold.
constexpr std::size_t byte_lanes = 48, most_byte_rows = 128;

// Planes of `images` (s, t) pairs times `texels` (u, v) places, less the background, in codes.
struct Ycocg8Planes {
    float* plane[3];
    std::int32_t background[3]; // Y, Co, Cg of an 8-bit RGB texel
    int texels, images;
    // Of each square of eight texels and eight images, whether the planes are known to be 0 there; kept up to
    // date.
    std::uint8_t* is_zero;
};

struct SearchKernels {
    // One orthonormal forward DCT pass; basis_t[x * n + k] (forward_basis). Rows lie `stride` apart.
    void (*forward_rows)(const float* in, float* out, int rows, int n, int stride,
                         const float* basis_t);
    // Along an outer axis, of `width` signals side by side whose values lie in_step, frequencies out_step
    // apart.
    void (*forward_planes)(const float* in, int in_step, float* out, int out_step, int n, int width,
                           const float* basis_t);

    // Along t and then s of a cell, from one plane into another of the same tile.
    void (*forward_views)(const float* in, float* out, const CellViews& cell);

    // Orthonormal 2D DCT of an image of nu x nv floats whose rows lie `stride` apart. Only the
    // lowest forward_kept(nu) x forward_kept(nv) frequencies are written, row v after row v, the u
    // frequencies of a row in the order of forward_order(nu).
    void (*forward_image)(const float* in, int stride, int nu, int nv, float* out);
    // to[i] = x[i] * scale, rounded, within +- matching_limit.
    void (*to_matching_units)(const float* x, float scale, int n, std::int16_t* to);
    // sums[i] += (a[i] - b[i])^2 over `rows` rows of n such values; row y of b is the one at first + y
    // within 0..last. Rows of a lie a_stride apart, those of b b_stride. rows <= 64.
    void (*add_squared_differences)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                    int b_stride, int first, int last, int rows, int n,
                                    float* sums);
    // The same of pairs of columns, i < n / 2; n is even.
    void (*add_squared_pairs)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                              int b_stride, int first, int last, int rows, int n, float* sums);
    // Their sum.
    std::uint64_t (*squared_differences)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                         int b_stride, int first, int last, int rows, int n);
    // Sum over x of min(a^2, base + slope * max(0, log2(a^2))) with a = x * inverse_step: the cost
    // of zeroing or of coding each (see cell_costs.cpp). base is in the order of x.
    CostSum (*coding_cost)(const float* x, const float* base, int count, float inverse_step,
                           float slope);
    // Of n floats.
    float (*largest_magnitude)(const float* x, int n);
    // Bit i: whether the colour (y[i], co[i], cg[i]) has at least that squared length in RGB. n <= 64.
    std::uint64_t (*long_colours)(const float* y, const float* co, const float* cg, int n,
                                  float least);
    // sum += x, squares += x^2 over n floats: four partial sums of each, then (0 + 1) + (2 + 3) of them.
    void (*add_row)(const float* x, int n, float* sum, float* squares);
    // The same of each of `count` runs of four floats, one behind the other, into sums[i], squares[i].
    void (*add_quads)(const float* x, int count, float* sums, float* squares);
    // Of n cells with these sums, sums of squares and numbers of texels: energy[i] += scale * that about the
    // cell's mean, of_mean[i] = scale * that of its mean.
    void (*measure_cells)(const float* sums, const float* squares, const float* texels, int n,
                          float scale, float* energy, float* of_mean);
    // to[i] = to[i] + x[2 i] + x[2 i + 1], n of them; the same of x[i].
    void (*add_pairs)(const float* x, int n, float* to);
    void (*add_singles)(const float* x, int n, float* to);
    // From 8-bit RGB with the pairs fastest: colour transform and transposition in one (FORMAT.md 4.5).
    void (*load_ycocg8)(const Ycocg8Planes& to, const unsigned char* in);
    ByteErrors (*compare_bytes)(const unsigned char* a, const unsigned char* b, std::size_t n);
    // sums[i] += a[i] - b[i] of the byte_lanes columns of as many rows, most_byte_rows at most.
    void (*add_byte_differences)(const unsigned char* a, const unsigned char* b, std::size_t rows,
                                 std::int16_t* sums);
    // The cheapest path through the states of dependent quantisation.
    TrellisEnd (*run_trellis)(const TrellisTask& task);
    // to = in - predicted * unit, of `rows` rows of n values; those of `in` lie `stride` apart, others are dense.
    void (*subtract_predicted)(const float* in, int stride, const std::int32_t* predicted,
                               float unit, int rows, int n, float* to);
};

// Of kernel_path().
const SearchKernels& search_kernels();

extern const SearchKernels search_kernels_scalar;
extern const SearchKernels search_kernels_avx2; // only where avx2_available()

} // namespace tessera
