// The integer inverse transform of FORMAT.md 4.3, for all planes of a frequency at once. Sums are
// unsigned, so that they wrap in every language.
#ifndef TSR_TRANSFORM
#define TSR_TRANSFORM
#include "buffers.glsl"

// b(n, k, x): word of k = 0, x = 0.
int tsr_basis_of(int n) {
    if (n > tsr_max_frequencies) // a table of n has only the rows of the coded frequencies
        return tsr_t_wide_basis + tsr_max_frequencies / 2 *
                                      (n * (n - 1) - (tsr_max_frequencies + 1) * tsr_max_frequencies);
    return tsr_t_basis + ((n - 1) * n * (2 * n - 1)) / 6;
}
uint tsr_basis(int basis, int n, int k, int x) {
    return tsr_table(basis + k * n + x);
}

// A sum of products as H and L, and of how many planes: x, y, z are planes 0 to 2 (or plane 3 in x).
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

// A pass clamps what goes into it.
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
