// Beside pass 2, one invocation per chunk of 4,096 texels: decodes the multipliers of the
// corrections (FORMAT.md 3.6), signed, texel by texel with channels adjacent.
#include "rans.glsl"

struct TsrChunkWalk {
    TsrRans r;
    uint at;     // word of the tile's first multiplier
    uint planes;
    uint first;  // texel of the chunk
    uint step_t; // texels from one t to the next
    uint step_u; // texels from one angular image to the next
};

uint tsr_capped(uint word) {
    return min(int(word) < 0 ? 0u - word : word, 2u);
}

// min(|multiplier|, 2) of the same channel `back` texels earlier; 0 before the chunk.
uint tsr_multiplier_back(TsrChunkWalk w, uint texel, uint channel, uint back) {
    if (texel < w.first + back)
        return 0u;
    return tsr_capped(tsr_work_word(w.at + (texel - back) * w.planes + channel));
}

uint tsr_multiplier(TSR_INOUT(TsrChunkWalk) w, uint texel, uint channel, uint before) {
    uint near = tsr_multiplier_back(w, texel, channel, 1u) +
                tsr_multiplier_back(w, texel, channel, w.step_t) +
                tsr_multiplier_back(w, texel, channel, w.step_u);
    uint context = 3u * near + before;
    int token = tsr_symbol(w.r, uint(tsr_t_correction) + context * uint(tsr_symbol_words));
    uint value = 0u;
    if (token > 0) {
        // The format allows this clamp. It keeps the product with the step within 32 bits.
        int magnitude = int(min(tsr_magnitude(w.r, token - 1), 65536u));
        value = uint(tsr_raw(w.r, 1) != 0u ? -magnitude : magnitude);
    }
    tsr_set_work(w.at + texel * w.planes + channel, value);
    return tsr_capped(value);
}

void tsr_decode_corrections(uint stream) {
    if (stream >= tsr_header(tsr_b_corrections))
        return;
    uint record = tsr_header(tsr_b_correction_at) + stream * uint(tsr_correction_words);
    uint tile = tsr_batch_word(record + uint(tsr_correction_tile));
    ivec4 sides = tsr_sides_of(tsr_tile(tile, tsr_tile_shape));
    uint texels = uint(sides.x * sides.y * sides.z * sides.w);
    TsrChunkWalk w;
    w.r = tsr_begin(tsr_batch_word(record + uint(tsr_correction_byte)),
                    tsr_batch_word(record + uint(tsr_correction_size)));
    w.at = tsr_header(tsr_b_multipliers_at) + tsr_tile(tile, tsr_tile_multipliers);
    w.planes = tsr_table(tsr_t_planes);
    w.first =
        tsr_batch_word(record + uint(tsr_correction_number)) * uint(tsr_correction_chunk);
    w.step_t = uint(sides.z);
    w.step_u = uint(sides.z * sides.w);
    for (uint i = 0u; i < uint(tsr_correction_chunk); ++i) {
        TSR_LOOP;
        uint texel = w.first + i;
        if (texel >= texels)
            break;
        uint before = tsr_multiplier(w, texel, 0u, 0u);
        if (w.planes > 1u)
            before = tsr_multiplier(w, texel, 1u, before);
        if (w.planes > 2u)
            before = tsr_multiplier(w, texel, 2u, before);
        if (w.planes > 3u)
            before = tsr_multiplier(w, texel, 3u, before);
    }
    if (!tsr_ended_well(w.r))
        tsr_damage(tile, tsr_damage_corrections);
}

#ifndef __cplusplus
layout(local_size_x = TSR_STREAM_GROUP) in;
void main() {
    tsr_decode_corrections(gl_GlobalInvocationID.x);
}
#endif
