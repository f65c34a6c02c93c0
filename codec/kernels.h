// The hot loops, compiled once per instruction set from codec/kernels.inl and picked once per
// process.
//
// Every path gives the same bits: the integer kernels because their sums are exact modulo 2^32, the
// float ones (which only steer the encoder) because lanes are outputs or fixed partial sums, never
// a width the compiler chooses, and contraction is off.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tessera {

// A block inside arrays of a tile in the order t, s, v, u (u fastest).
struct BlockView {
    std::array<int, 4> n;      // sides along u, v, s, t
    std::array<int, 3> stride; // of v, s, t
};

// Y, Co, Cg of a tile without the background's share, in the order (t, s) image, (v, u) texel.
struct PlaneSet {
    const std::int32_t* plane[3];
    std::int32_t background[3];
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

    // Planes of `images` (s, t) pairs times `texels` (u, v) places -> 8-bit RGB with the pairs
    // fastest: colour transform, clamp and transposition in one (FORMAT.md 4.5).
    void (*store_ycocg8)(const PlaneSet& in, int texels, int images, unsigned char* out);

    // One orthonormal forward DCT pass; basis_t[x * n + k]. Rows lie `stride` floats apart.
    void (*forward_rows)(const float* in, float* out, int rows, int n, int stride,
                         const float* basis_t);
    // Along an outer axis, over `inner` contiguous floats.
    void (*forward_planes)(const float* in, float* out, int n, int inner, const float* basis_t);

    // Sum over a block's coefficients x of min(a^2, base + slope * max(0, log2(a^2))) with
    // a = x * inverse_step: the cost of zeroing or of coding each (see block_search.cpp).
    // base: contiguous in block order.
    float (*coding_cost)(const float* x, const BlockView& block, const float* base,
                         float inverse_step, float slope);
};

// The path in use: the best this CPU has, or the one that the environment variable TESSERA_SIMD
// names ("scalar", "avx2").
const Kernels& kernels();

extern const Kernels kernels_scalar;
extern const Kernels kernels_avx2; // only where avx2_available()
bool avx2_available();

} // namespace tessera
