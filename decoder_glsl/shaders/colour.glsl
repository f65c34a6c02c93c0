// Converts transform outputs to samples (FORMAT.md 4.5).
#ifndef TSR_COLOUR
#define TSR_COLOUR
#include "buffers.glsl"

// The tables' fields about samples, loaded once per invocation.
struct TsrFormat {
    bool half_floats; // else unorm8
    int planes;
    bool ycocg;
    bool smooth_copies;
    bool filtered;    // filter.comp writes the texels
    int fraction;     // bits of a transform output below a code
    int value_bits;   // bits of a value below a code
    ivec4 background; // planes
    int smallest;     // code
    int largest;
};

TsrFormat tsr_format() {
    TsrFormat f;
    f.half_floats = tsr_table(tsr_t_sample_type) != 0u;
    f.planes = int(tsr_table(tsr_t_planes));
    f.ycocg = tsr_table(tsr_t_colour) == 1u;
    f.smooth_copies = tsr_table(tsr_t_smooth) != 0u;
    f.filtered = tsr_table(tsr_t_filtered) != 0u;
    f.fraction = int(tsr_table(tsr_t_fraction));
    f.value_bits = f.half_floats ? 0 : 4;
    f.background = ivec4(int(tsr_table(tsr_t_background)), int(tsr_table(tsr_t_background + 1)),
                         int(tsr_table(tsr_t_background + 2)),
                         int(tsr_table(tsr_t_background + 3)));
    f.largest = f.half_floats ? 31743 : 255;
    f.smallest = f.half_floats ? -31743 : 0;
    return f;
}

// Transform outputs of all planes, rounded to values.
ivec4 tsr_values(TsrFormat f, ivec4 outputs) {
    // Outputs of sound tiles are below 2^28. Unsigned sums let any others wrap.
    int shift = f.fraction - f.value_bits;
    return ivec4(uvec4(outputs) + (1u << uint(shift - 1))) >> shift;
}

// Values of all planes to codes: adds the background, inverts the colour transform and clamps.
ivec4 tsr_codes(TsrFormat f, ivec4 values) {
    ivec4 c = ((values + ((1 << f.value_bits) >> 1)) >> f.value_bits) + f.background;
    if (f.ycocg) {
        int t = c.x - (c.z >> 1);
        int g = c.z + t;
        int b = t - (c.y >> 1);
        c = ivec4(b + c.y, g, b, c.w);
    }
    return clamp(c, f.smallest, f.largest);
}

// The bits of a half, or the byte, that a code stands for.
uint tsr_sample_of(int code) {
    return uint(code >= 0 ? code : 0x8000 | -code);
}

// Codes as the four channels of the texture: grey in all three colours, alpha 1 where the file has
// none.
uvec4 tsr_samples(TsrFormat f, ivec4 codes) {
    uint one = f.half_floats ? 0x3C00u : 255u;
    uint x = tsr_sample_of(codes.x);
    uint y = tsr_sample_of(codes.y);
    if (f.planes == 1)
        return uvec4(x, x, x, one);
    if (f.planes == 2)
        return uvec4(x, x, x, y);
    return uvec4(x, y, tsr_sample_of(codes.z), f.planes == 4 ? tsr_sample_of(codes.w) : one);
}

#endif
