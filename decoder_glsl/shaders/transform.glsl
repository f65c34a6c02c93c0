// The integer inverse transform of FORMAT.md 4.3, for three planes at once. Sums are unsigned,
// because unsigned overflow wraps in GLSL and in C++.
#ifndef TSR_TRANSFORM
#define TSR_TRANSFORM
#include "buffers.glsl"

// Word of b(n, 0, 0). b(n, k, x) is n k + x words further on.
int tsr_basis_of(int n) {
    if (n > tsr_max_frequencies) // tables of longer sides have the coded frequencies only
        return tsr_t_wide_basis +
               tsr_max_frequencies / 2 *
                   (n * (n - 1) - (tsr_max_frequencies + 1) * tsr_max_frequencies);
    return tsr_t_basis + ((n - 1) * n * (2 * n - 1)) / 6;
}

// Word of s(n, 0, 0), for n up to tsr_max_sine_side. s(n, k, x) is n k + x words further on.
int tsr_sine_basis_of(int n) {
    return tsr_t_sine_basis + ((n - 1) * n * (2 * n - 1)) / 6;
}

// A sum of products in two halves, H and L of the format: x, y, z are planes 0 to 2, or x is plane
// 3.
struct TsrSum {
    uvec3 high;
    uvec3 low;
};

TsrSum tsr_no_sum() {
    TsrSum sum;
    sum.high = uvec3(0u);
    sum.low = uvec3(0u);
    return sum;
}

// Every pass clamps its inputs.
ivec3 tsr_clamped(ivec3 value) {
    return clamp(value, -(1 << 26), (1 << 26) - 1);
}

// Precondition: the value is clamped.
void tsr_add_clamped(TSR_INOUT(TsrSum) sum, uint basis, ivec3 value) {
    sum.high += basis * uvec3(value >> 11);
    sum.low += basis * uvec3(value & 2047);
}

void tsr_add(TSR_INOUT(TsrSum) sum, uint basis, ivec3 value) {
    tsr_add_clamped(sum, basis, tsr_clamped(value));
}

ivec3 tsr_rounded(TsrSum sum) {
    return ivec3(sum.high + uvec3(ivec3(sum.low + (1u << 14)) >> 11)) >> 4;
}

#endif
