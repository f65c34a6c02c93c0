// The hot loops, compiled once per instruction set from codec/kernels/kernels.inl and picked once per
// process.
//
// Every path gives the same bits: the integer kernels because their sums are exact modulo 2^32, the
// float ones (which only steer the encoder) because lanes are outputs or fixed partial sums, never
// a width the compiler chooses, and contraction is off.
#pragma once

#include "format/tile/tile_filter.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

// What coding some coefficients would cost, and their energy, both in squared steps. Of the cost,
// what is due to those that are zeroed and to the bases of the others, and how many these are.
struct CostSum {
    float cost = 0, energy = 0;
    float zeroed = 0, bases = 0, coded = 0;
};

// Y, Co, Cg of a tile without the background's share, in sixteenths of a code, in the order (t, s)
// image, (v, u) texel; the background's share in codes.
struct PlaneSet {
    const std::int32_t* plane[3];
    std::int32_t background[3];
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

// A filter that copies go through (FORMAT.md 4.6): f + 2 g, plus 4 for smooth ones; and how many bits
// its sums lie above the values.
constexpr int copy_filter(bool smooth, int half_u, int half_v) {
    return (smooth ? 4 : 0) + 2 * (half_v & 1) + (half_u & 1);
}
constexpr int copy_shift(bool smooth) {
    return smooth ? 4 : 2;
}

// The filter of FORMAT.md 4.7 for one plane; four taps a ring.
struct FilterTaps {
    std::array<std::int32_t, filter_rings> strength;
    std::array<std::uint32_t, filter_rings> slope;
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

    // out = floor((in + 2^(shift - 1)) / 2^shift) for rows x n values; out's rows lie `stride` apart.
    void (*round_rows)(const std::int32_t* in, std::int32_t* out, int rows, int n, int stride,
                       int shift);

    // sums[i] += C of FORMAT.md 4.6 from rows j - 1, j, j + 1. Smooth filters read texels -1..n of
    // them, plain ones 0..n, and neither a row that its filter does without.
    void (*add_copies)(const std::int32_t* const rows[3], int filter, int n, std::int32_t* sums);

    // out[i] = floor((sum over j < 6 of weights[j] * rows[j][i] + 2^(shift - 1)) / 2^shift): one axis
    // of a copy from a base picture (FORMAT.md 4.6).
    void (*six_taps)(const std::int32_t* const* rows, const std::int8_t* weights, int shift, int n,
                     std::int32_t* out);

    // values[i] = values[i] + (sums[i] >> shift), within -limit .. limit - 1.
    void (*add_within)(std::int32_t* values, const std::int32_t* sums, int shift, int n,
                       std::int32_t limit);

    // Planes of `images` (s, t) pairs times `texels` (u, v) places -> 8-bit RGB with the pairs
    // fastest: colour transform, clamp and transposition in one (FORMAT.md 4.5).
    void (*store_ycocg8)(const PlaneSet& in, int texels, int images, unsigned char* out);

    // out = values within -limit .. limit - 1, which fit; returns all bits set in any of them.
    std::int32_t (*clamp_row)(const std::int32_t* values, int n, std::int32_t limit,
                              std::int16_t* out);
    std::int32_t (*clamp_wide_row)(const std::int32_t* values, int n, std::int32_t limit,
                                   std::int32_t* out);
    // out = the filtered values of a row of n; from: where the neighbours of its first value stand, ring
    // after ring; of unorm8 and, in the second, half16. Values are within value_limit; up to 15 past a row are read and have no effect.
    void (*filter_row)(const std::int16_t* centre, const std::int16_t* const* from,
                       const FilterTaps& taps, int n, std::int32_t* out);
    void (*filter_wide_row)(const std::int32_t* centre, const std::int32_t* const* from,
                            const FilterTaps& taps, int n, std::int32_t* out);

    // One orthonormal forward DCT pass; basis_t[x * n + k] (forward_basis). Rows lie `stride` apart.
    void (*forward_rows)(const float* in, float* out, int rows, int n, int stride,
                         const float* basis_t);
    // Along an outer axis, over `inner` contiguous floats.
    void (*forward_planes)(const float* in, float* out, int n, int inner, const float* basis_t);

    // Orthonormal 2D DCT of an image of nu x nv floats whose rows lie `stride` apart. Only the
    // lowest forward_kept(nu) x forward_kept(nv) frequencies are written, row v after row v, the u
    // frequencies of a row in the order of forward_order(nu).
    void (*forward_image)(const float* in, int stride, int nu, int nv, float* out);
    // sums[i] += (a[i] - b[i])^2 over `rows` rows of n floats; row y of b is the one at
    // first + y within 0..last. Rows of a lie a_stride apart, those of b b_stride.
    void (*add_squared_differences)(const float* a, int a_stride, const float* b, int b_stride,
                                    int first, int last, int rows, int n, float* sums);
    // Sum over x of min(a^2, base + slope * max(0, log2(a^2))) with a = x * inverse_step: the cost
    // of zeroing or of coding each (see block_search.cpp). base is in the order of x.
    CostSum (*coding_cost)(const float* x, const float* base, int count, float inverse_step,
                           float slope);
    // Rows of 8 bytes, one for each path of the trellis: byte i becomes byte before[i] < 8 of its row.
    // Up to 3 rows behind the last are changed alike.
    void (*follow_paths)(std::uint8_t* rows, int count, const std::uint8_t* before);
};

// The path in use: the best this CPU has, or the one that the environment variable TESSERA_SIMD
// names ("scalar", "avx2").
const Kernels& kernels();

extern const Kernels kernels_scalar;
extern const Kernels kernels_avx2; // only where avx2_available()
bool avx2_available();

} // namespace tessera
