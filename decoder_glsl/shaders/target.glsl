// The pixels that the texels of a tile go to, and the words in which its values wait for copies and
// for the filter.
#ifndef TSR_TARGET
#define TSR_TARGET
#include "colour.glsl"

#ifndef __cplusplus
#ifdef TSR_TRANSLATED
// WebGPU cannot write words to an image of bytes or halves, so these are written as numbers.
#ifdef TSR_OUTPUT_HALF
layout(rgba16f, TSR_IMAGE(0)) writeonly uniform highp image2DArray tsr_image;
void tsr_write_texel(ivec3 at, uvec4 samples) {
    vec2 a = unpackHalf2x16(samples.x | (samples.y << 16));
    vec2 b = unpackHalf2x16(samples.z | (samples.w << 16));
    imageStore(tsr_image, at, vec4(a.x, a.y, b.x, b.y));
}
#else
layout(rgba8, TSR_IMAGE(0)) writeonly uniform highp image2DArray tsr_image;
void tsr_write_texel(ivec3 at, uvec4 samples) {
    imageStore(tsr_image, at, vec4(samples) / 255.0);
}
#endif
#elif defined(TSR_OUTPUT_HALF)
layout(rgba16ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_image;
void tsr_write_texel(ivec3 at, uvec4 samples) {
    imageStore(tsr_image, at, samples);
}
#else
layout(r32ui, TSR_IMAGE(0)) writeonly uniform highp uimage2DArray tsr_image;
void tsr_write_texel(ivec3 at, uvec4 samples) {
    uint word = samples.x | (samples.y << 8) | (samples.z << 16) | (samples.w << 24);
    imageStore(tsr_image, at, uvec4(word, 0u, 0u, 0u));
}
#endif
#endif

// A plain texture folds its angular images over layers where a row of all of them would be wider
// than a texture may be. A cache folds nothing: its folds are wider than any tile. Positions are
// unsigned, so that those of damaged batches wrap.
struct TsrTarget {
    uvec3 pixel; // x, y and layer of the tile's first texel
    uvec2 first; // (u, v) of that texel, where texels are folded
    uvec2 fold;  // angular images per layer, along u and v
    uint folds_u;
    uvec2 stride;     // pixels from one angular image to the next
    uint multipliers; // word of the tile's corrections, or none
    uint values;      // word of its kept values, or none
    uint stored;      // byte of a stored tile's first sample, or none
    ivec4 sides;      // of the tile
    ivec2 base_sides; // of its base picture; 0 where it has none
    int step;         // of corrections
};

TsrTarget tsr_target(uint tile) {
    TsrTarget t;
    uint origin = tsr_tile(tile, tsr_tile_origin);
    t.pixel = uvec3(tsr_tile(tile, tsr_tile_x), tsr_tile(tile, tsr_tile_y),
                    tsr_tile(tile, tsr_tile_layer));
    t.first = uvec2(origin & 0xFFFFu, origin >> 16);
    t.fold = uvec2(max(tsr_header(tsr_b_fold_u), 1u), max(tsr_header(tsr_b_fold_v), 1u));
    t.folds_u = tsr_header(tsr_b_folds_u);
    t.stride = uvec2(tsr_header(tsr_b_stride_s), tsr_header(tsr_b_stride_t));
    uint multipliers = tsr_tile(tile, tsr_tile_multipliers);
    // A damaged tile is drawn as background, without the corrections that it has decoded.
    bool damaged = tsr_is_damaged(tile);
    t.multipliers = damaged || multipliers == tsr_none
                        ? tsr_none
                        : tsr_header(tsr_b_multipliers_at) + multipliers;
    uint values = tsr_tile(tile, tsr_tile_values);
    t.values = damaged || values == tsr_none ? tsr_none : tsr_header(tsr_b_values_at) + values;
    t.stored = damaged ? tsr_none : tsr_tile(tile, tsr_tile_stored);
    t.sides = tsr_sides_of(tsr_tile(tile, tsr_tile_shape));
    uint base = tsr_tile(tile, tsr_tile_base);
    ivec4 base_sides = tsr_sides_of(base);
    t.base_sides = base == tsr_none ? ivec2(0) : ivec2(base_sides.x, base_sides.y);
    t.step = int(tsr_table(tsr_t_correction_step));
    return t;
}

// The pixel of the tile's texel (u, v, 0, 0).
uvec3 tsr_place(TsrTarget dest, int u, int v) {
    uvec2 all = dest.first + uvec2(uint(u), uint(v));
    uvec2 fold = uvec2(all.x / dest.fold.x, all.y / dest.fold.y);
    return dest.pixel + uvec3((all.x - fold.x * dest.fold.x) * dest.stride.x,
                                (all.y - fold.y * dest.fold.y) * dest.stride.y,
                                fold.y * dest.folds_u + fold.x);
}

// The number of a texel in its tile (FORMAT.md part 2).
uint tsr_texel_number(TsrTarget dest, int u, int v, int s, int t) {
    return uint(((v * dest.sides.x + u) * dest.sides.w + t) * dest.sides.z + s);
}

ivec4 tsr_corrected(TsrFormat format, TsrTarget dest, ivec4 codes, int u, int v, int s, int t) {
    if (dest.multipliers == tsr_none)
        return codes;
    int planes = format.planes;
    uint texel = tsr_texel_number(dest, u, v, s, t);
    uint at = dest.multipliers + texel * uint(planes);
    ivec4 multiplier =
        ivec4(int(tsr_work_word(at)), planes > 1 ? int(tsr_work_word(at + 1u)) : 0,
              planes > 2 ? int(tsr_work_word(at + 2u)) : 0,
              planes > 3 ? int(tsr_work_word(at + 3u)) : 0);
    // Steps are below 2^17 and a product that large leaves the range of codes anyway.
    ivec4 limit = ivec4(65536 / max(dest.step, 1) + 1);
    return clamp(codes + clamp(multiplier, -limit, limit) * dest.step, format.smallest,
                 format.largest);
}

// The code of a stored tile's sample at a byte of the payload area.
int tsr_stored_code(TsrFormat format, uint at) {
    uint word = tsr_payload_word(at);
    if (!format.half_floats)
        return int(word & 255u);
    int magnitude = min(int(word & 0x7FFFu), format.largest);
    return (word & 0x8000u) != 0u ? -magnitude : magnitude;
}

// The codes of a texel of a stored tile (FORMAT.md 3.2).
ivec4 tsr_stored(TsrFormat format, TsrTarget dest, int u, int v, int s, int t) {
    int planes = format.planes;
    uint size = format.half_floats ? 2u : 1u;
    uint at = dest.stored + tsr_texel_number(dest, u, v, s, t) * uint(planes) * size;
    return ivec4(tsr_stored_code(format, at),
                 planes > 1 ? tsr_stored_code(format, at + size) : 0,
                 planes > 2 ? tsr_stored_code(format, at + 2u * size) : 0,
                 planes > 3 ? tsr_stored_code(format, at + 3u * size) : 0);
}

// Word of a texel's kept values: planes 0 and 1, or plane 0 of halves. The others follow at
// multiples of tsr_value_stride().
uint tsr_value_at(TsrTarget dest, int u, int v, int s, int t) {
    return dest.values +
           uint(((t * dest.sides.z + s) * dest.sides.y + v) * dest.sides.x + u);
}
uint tsr_tile_texels(TsrTarget dest) {
    return uint(dest.sides.x * dest.sides.y) * uint(dest.sides.z * dest.sides.w);
}
uint tsr_value_stride(TsrTarget dest) {
    return tsr_tile_texels(dest) + uint(dest.base_sides.x * dest.base_sides.y);
}
// The same for the texel of the base picture at (u, v), or at its edge. Its values follow the
// tile's.
uint tsr_base_value_at(TsrTarget dest, int u, int v) {
    return dest.values + tsr_tile_texels(dest) +
           uint(clamp(v, 0, max(dest.base_sides.y - 1, 0)) * dest.base_sides.x +
                clamp(u, 0, max(dest.base_sides.x - 1, 0)));
}

// Whether values are those of halves. The host compiles shaders for one sample type.
bool tsr_half_values(TsrFormat format) {
#ifdef __cplusplus
    return format.half_floats;
#elif defined(TSR_OUTPUT_HALF)
    return true;
#else
    return false;
#endif
}

// Kept values lie within -limit .. limit - 1 (FORMAT.md 4.6).
int tsr_value_limit(TsrFormat format) {
    return tsr_half_values(format) ? 1 << 18 : 1 << 14;
}

// The planes of a word: two of 16 bits each, or one of 20 bits.
ivec2 tsr_two_values(uint word) {
    return ivec2(int(word << 16u) >> 16, int(word) >> 16);
}
int tsr_one_value(uint word) {
    return int(word << 12u) >> 12;
}

// The values of all planes, the first of which is at word `at`.
ivec4 tsr_value_in(TsrFormat format, TsrTarget dest, uint at) {
    int planes = format.planes;
    uint stride = tsr_value_stride(dest);
    if (tsr_half_values(format))
        return ivec4(tsr_one_value(tsr_work_word(at)),
                     planes > 1 ? tsr_one_value(tsr_work_word(at + stride)) : 0,
                     planes > 2 ? tsr_one_value(tsr_work_word(at + 2u * stride)) : 0,
                     planes > 3 ? tsr_one_value(tsr_work_word(at + 3u * stride)) : 0);
    ivec2 low = tsr_two_values(tsr_work_word(at));
    ivec2 high = tsr_two_values(planes > 2 ? tsr_work_word(at + stride) : 0u);
    return ivec4(low.x, low.y, high.x, high.y);
}

// The values at (u, v), or at the tile's edge, of the view (s, t).
ivec4 tsr_value(TsrFormat format, TsrTarget dest, int u, int v, int s, int t) {
    return tsr_value_in(format, dest,
                        tsr_value_at(dest, clamp(u, 0, dest.sides.x - 1),
                                     clamp(v, 0, dest.sides.y - 1), s, t));
}

// `at`: the value's first word, as in tsr_value_in().
void tsr_keep_value(TsrFormat format, TsrTarget dest, ivec4 value, uint at) {
    int planes = format.planes;
    uint stride = tsr_value_stride(dest);
    uvec4 word = uvec4(value);
    if (!tsr_half_values(format)) {
        tsr_set_work(at, (word.x & 0xFFFFu) | (word.y << 16));
        if (planes > 2)
            tsr_set_work(at + stride, (word.z & 0xFFFFu) | (word.w << 16));
        return;
    }
    tsr_set_work(at, word.x);
    if (planes > 1)
        tsr_set_work(at + stride, word.y);
    if (planes > 2)
        tsr_set_work(at + 2u * stride, word.z);
    if (planes > 3)
        tsr_set_work(at + 3u * stride, word.w);
}

#endif
