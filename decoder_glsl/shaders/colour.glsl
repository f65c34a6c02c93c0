// From transform outputs to samples (FORMAT.md 4.5).
#ifndef TSR_COLOUR
#define TSR_COLOUR
#include "buffers.glsl"

// The codes of a texel: rounded planes onto the background, colour transform undone, clamped.
int tsr_largest_code() {
    return tsr_table(tsr_t_sample_type) == 0u ? 255 : 31743;
}
int tsr_smallest_code() {
    return tsr_table(tsr_t_sample_type) == 0u ? 0 : -31743;
}

ivec4 tsr_codes(ivec4 outputs) {
    int fraction = int(tsr_table(tsr_t_fraction));
    ivec4 background = ivec4(int(tsr_table(tsr_t_background)), int(tsr_table(tsr_t_background + 1)),
                             int(tsr_table(tsr_t_background + 2)),
                             int(tsr_table(tsr_t_background + 3)));
    // Outputs are below 2^28; unsigned, so that anything else wraps in every language.
    ivec4 c = (ivec4(uvec4(outputs) + (1u << uint(fraction - 1))) >> fraction) + background;
    if (tsr_table(tsr_t_colour) == 1u) {
        int t = c.x - (c.z >> 1);
        int g = c.z + t;
        int b = t - (c.y >> 1);
        c = ivec4(b + c.y, g, b, c.w);
    }
    return clamp(c, tsr_smallest_code(), tsr_largest_code());
}

// Codes as the four channels that are stored and sampled: grey in all three colours, alpha 1 where
// the texture has none. unorm8: 0..255; half16: the bits of a half.
uint tsr_sample_of(int code) {
    return uint(tsr_table(tsr_t_sample_type) == 0u || code >= 0 ? code : 0x8000 | -code);
}
uvec4 tsr_samples(ivec4 codes) {
    int planes = int(tsr_table(tsr_t_planes));
    uint one = tsr_table(tsr_t_sample_type) == 0u ? 255u : 0x3C00u;
    uint x = tsr_sample_of(codes.x);
    uint y = tsr_sample_of(codes.y);
    if (planes == 1)
        return uvec4(x, x, x, one);
    if (planes == 2)
        return uvec4(x, x, x, y);
    return uvec4(x, y, tsr_sample_of(codes.z), planes == 4 ? tsr_sample_of(codes.w) : one);
}

#endif
