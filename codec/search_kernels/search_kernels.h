// The hot loops of the encoder's search, which use floats, compiled and picked like those in
// codec/kernels. All paths give the same bits: lanes are outputs or partial sums in a fixed order,
// and products and sums are not contracted.
#pragma once

#include "codec/kernels/kernels.h"
#include "format/tile/code_tables.h"
#include "format/tile/dequantizer.h"
#include "format/tile/scan_order.h"

#include <cstddef>
#include <cstdint>

namespace tessera {

// The estimated cost of coding some coefficients, and their energy, both in squared steps. Parts of
// the cost: the energy of the coefficients that become 0, and the bases of the `coded` others.
struct CostSum {
    float cost = 0, energy = 0;
    float zeroed = 0, bases = 0, coded = 0;
};

// How many frequencies forward_image computes along a side. Long sides keep half, because a block
// that needs more frequencies is always cheaper when it is split.
constexpr int forward_kept(int n) {
    return n >= 32 ? (n + 1) / 2 : n;
}
// The frequency at index i of a row. Sides with a butterfly have the even ones first.
constexpr int forward_order(int n, int i) {
    const bool butterfly = n == 4 || n == 8 || n == 16 || n == 32 || n == 64;
    const int half = forward_kept(n) / 2;
    return !butterfly ? i : i < half ? 2 * i : 2 * (i - half) + 1;
}

// More than any path costs.
constexpr float unreachable_cost = 1e30f;

// Four rows of the trellis fill 32 bytes. A row has a coefficient's amplitude on each state's path.
constexpr int trellis_rows_at_once = 4;
struct alignas(32) TrellisRows {
    std::uint8_t row[trellis_rows_at_once][quantiser_states];
};

// The coefficients of a plane in scan order and what levels cost, in bits. Indices of a quantiser's
// zero flags: [row][is non-zero][class of neighbours]; of its magnitudes: [row][token][class].
struct TrellisTask {
    int count;
    const float* amplitude;          // in steps
    const std::uint16_t* neighbours; // ScanOrder's, scan_neighbours per coefficient
    const ScanContext* context;
    int first_class; // class of the first coefficient, which has no neighbours
    const std::uint16_t* flag_row;
    const std::uint8_t* token_row;
    const float* end_cost; // cost of ending after each coefficient; unreachable_cost: impossible
    float zero_cost;       // cost of coding no levels
    const float* flags[quantisers];
    const float* tokens[quantisers];
    float lambda;
    float offsets[2]; // subtracted from level 1, and from larger levels, in reconstruction
    // Output for each coefficient and state after it: the state before on the best path, its level,
    // and its amplitude as contexts see it.
    std::uint8_t* before;
    std::int32_t* level;
    TrellisRows* seen;
};

// The end of the cheapest path.
struct TrellisEnd {
    float cost;
    int length, state;
};

// The layout of a cell in a plane: rows of `width` texels `row` apart, views `s` and `t` apart.
struct CellViews {
    int width, rows, ns, nt;
    int row, s, t;
};

// Limits matched values, so that squared differences of two columns of 64 rows sum to below 2^31.
constexpr int matching_limit = 2047;
// Kernels may read this many values past the last one.
constexpr std::size_t read_behind_matched = 3;

// The differences of two runs of bytes.
struct ByteErrors {
    std::uint64_t squared = 0; // sum of squares
    std::uint32_t largest = 0;
};

// How many columns add_byte_differences sums, and how many rows its 16-bit sums can hold.
constexpr std::size_t byte_lanes = 48, most_byte_rows = 128;

// Planes of `images` (s, t) pairs times `texels` (u, v) positions minus the background, in codes.
struct Ycocg8Planes {
    float* plane[3];
    std::int32_t background[3]; // Y, Co, Cg of the background's 8-bit RGB
    int texels, images;
    // For each square of 8 texels and 8 images, up to date: whether the planes are known to be 0.
    std::uint8_t* is_zero;
};

struct SearchKernels {
    // An orthonormal DCT pass over `rows` rows of n values, `stride` apart; needs forward_basis(n).
    void (*forward_rows)(const float* in, float* out, int rows, int n, int stride,
                         const float* basis_t);
    // The same along an outer axis, for `width` adjacent signals. The values of a signal lie
    // in_step apart, its frequencies out_step apart.
    void (*forward_planes)(const float* in, int in_step, float* out, int out_step, int n, int width,
                           const float* basis_t);

    // The same for any other orthonormal transform, transposed: basis_t[x * n + k].
    void (*plain_rows)(const float* in, float* out, int rows, int n, int stride,
                       const float* basis_t);
    void (*plain_planes)(const float* in, int in_step, float* out, int out_step, int n, int width,
                         const float* basis_t);

    // Transforms a cell along t and then along s, from one plane into another of the same tile.
    void (*forward_views)(const float* in, float* out, const CellViews& cell);

    // Orthonormal 2D DCT of nu x nv floats whose rows lie `stride` apart. Writes only the lowest
    // forward_kept(nu) x forward_kept(nv) frequencies, row by row, in the order of
    // forward_order(nu).
    void (*forward_image)(const float* in, int stride, int nu, int nv, float* out);
    // to[i] = x[i] * scale, rounded and clamped to +-matching_limit.
    void (*to_matching_units)(const float* x, float scale, int n, std::int16_t* to);
    // sums[i] += the sum of (a[i] - b[i])^2 over `rows` <= 64 rows of n values, whose strides are
    // a_stride and b_stride. Row y of `a` goes with row first + y of `b`, clamped to 0..last.
    void (*add_squared_differences)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                    int b_stride, int first, int last, int rows, int n,
                                    float* sums);
    // The same for pairs of adjacent columns: n is even and there are n / 2 sums.
    void (*add_squared_pairs)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                              int b_stride, int first, int last, int rows, int n, float* sums);
    // The total over all columns.
    std::uint64_t (*squared_differences)(const std::int16_t* a, int a_stride, const std::int16_t* b,
                                         int b_stride, int first, int last, int rows, int n);
    // Sums min(a^2, base + slope * max(0, log2(a^2))), a = x * inverse_step: the cost of setting
    // each coefficient to 0 or of coding it (see cell_costs.cpp). base is in the order of x.
    CostSum (*coding_cost)(const float* x, const float* base, int count, float inverse_step,
                           float slope);
    // The largest magnitude of n floats.
    float (*largest_magnitude)(const float* x, int n);
    // Bit i: whether the squared RGB length of (y[i], co[i], cg[i]) is at least `least`. n <= 64.
    std::uint64_t (*long_colours)(const float* y, const float* co, const float* cg, int n,
                                  float least);
    // sum += x, squares += x^2 over n floats, in four partial sums added as (0 + 1) + (2 + 3).
    void (*add_row)(const float* x, int n, float* sum, float* squares);
    // The same for each of `count` consecutive runs of four floats, into sums[i] and squares[i].
    void (*add_quads)(const float* x, int count, float* sums, float* squares);
    // sums[i] += the energy of x - predicted * unit in run i of `count` consecutive ones of four.
    void (*add_quad_errors)(const float* x, const std::int32_t* predicted, float unit, int count,
                            float* sums);
    // For n cells with the given sums, sums of squares and numbers of texels: energy[i] += scale *
    // the energy about the cell's mean; of_mean[i] = scale * the energy of the mean.
    void (*measure_cells)(const float* sums, const float* squares, const float* texels, int n,
                          float scale, float* energy, float* of_mean);
    // n times: to[i] = to[i] + x[2 i] + x[2 i + 1], or to[i] += x[i].
    void (*add_pairs)(const float* x, int n, float* to);
    void (*add_singles)(const float* x, int n, float* to);
    // 8-bit RGB with the pairs fastest to planes: transforms colour and transposes (FORMAT.md 4.5).
    void (*load_ycocg8)(const Ycocg8Planes& to, const unsigned char* in);
    ByteErrors (*compare_bytes)(const unsigned char* a, const unsigned char* b, std::size_t n);
    // sums[i] += a[i] - b[i] for byte_lanes columns of up to most_byte_rows rows.
    void (*add_byte_differences)(const unsigned char* a, const unsigned char* b, std::size_t rows,
                                 std::int16_t* sums);
    // Finds the cheapest path through the states of dependent quantisation.
    TrellisEnd (*run_trellis)(const TrellisTask& task);
    // to = in - predicted * unit for `rows` rows of n values, dense except `in`: `stride` apart.
    void (*subtract_predicted)(const float* in, int stride, const std::int32_t* predicted,
                               float unit, int rows, int n, float* to);
};

// The kernels that belong to kernel_path(). There are none for generic vectors.
const SearchKernels& search_kernels();

extern const SearchKernels search_kernels_scalar;
extern const SearchKernels search_kernels_avx2;   // may be used only if avx2_available()
extern const SearchKernels search_kernels_avx512; // may be used only if avx512_available()

} // namespace tessera
