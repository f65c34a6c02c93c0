// Pass 3, one invocation a level: dequantises it (FORMAT.md 4.1), turns rotated colours back (4.4)
// and puts it in the order in which the inverse transform sums: t, s, v, u frequency, u fastest.
//
// The place in that order is found by counting the coefficients of the block that go before: blocks
// hold tens of levels, and the passes that read them all stay uniform.
#include "buffers.glsl"

// The coefficient of a level, at most 2^26 either way; 0 is no level.
//
// `finer`: subtracted from the scale's exponent.
int tsr_dequantize(uint level, uint scale, int finer, int offset_at) {
    uint magnitude = level & 0xFFFFFu;
    if (magnitude == 0u)
        return 0;
    uint mantissa = scale & 0xFFFFu;
    int exponent = int(scale >> 16) - 128 - finer;
    uint offset = tsr_table(offset_at + (magnitude > 1u ? 1 : 0));
    uint product = magnitude * mantissa - ((mantissa * offset) >> 6);
    uint value = 0u;
    if (exponent < -31)
        value = 0u;
    else if (exponent < 0)
        value = min((product + (1u << uint(-exponent - 1))) >> uint(-exponent), 1u << 26);
    else if (exponent > 26 || product > ((1u << 26) >> uint(exponent)))
        value = 1u << 26;
    else
        value = product << uint(exponent);
    return (level & 0x100000u) != 0u ? -int(value) : int(value);
}

// Row `row` of a rotation times x, rounded as 4.4 says; 32-bit arithmetic does.
int tsr_turn_back(ivec3 x, int rotation, int row) {
    int at = tsr_t_rotation + rotation * 9 + row * 3;
    uint a = tsr_table(at);
    uint b = tsr_table(at + 1);
    uint c = tsr_table(at + 2);
    uint high = a * uint(x.x >> 11) + b * uint(x.y >> 11) + c * uint(x.z >> 11);
    uint low = a * uint(x.x & 2047) + b * uint(x.y & 2047) + c * uint(x.z & 2047);
    return int(high + uint(int(low + 2048u) >> 11)) >> 1;
}

struct TsrLevels { // of one frequency, in planes 0 to 2 or, in x, in plane 3
    uint x;
    uint y;
    uint z;
};

void tsr_take_level(TSR_INOUT(TsrLevels) found, uint level) {
    uint plane = level >> 30;
    if (plane == 1u)
        found.y = level;
    else if (plane == 2u)
        found.z = level;
    else
        found.x = level;
}

void tsr_order_level(uint slot) {
    uint chunk = slot >> 6;
    if (chunk >= tsr_header(tsr_b_raw_chunks))
        return;
    uint segment = tsr_batch_word(tsr_header(tsr_b_raw_chunk_at) + chunk);
    uint raw = tsr_segment(segment, tsr_seg_raw);
    uint tile = tsr_segment(segment, tsr_seg_tile);
    if (slot - raw >= tsr_work_word(tsr_header(tsr_b_counts_at) + segment) ||
        tsr_work_word(tsr_state_at(tile) + uint(tsr_st_damaged)) != 0u)
        return;
    uint raw_at = tsr_header(tsr_b_raw_at);
    uint own_key = tsr_work_word(raw_at + slot * 2u);
    uint own_level = tsr_work_word(raw_at + slot * 2u + 1u);
    uint own_plane = own_level >> 30;

    uint block = tsr_block_at(tile, own_key & 0xFFFu);
    uint counts = tsr_work_word(block + uint(tsr_k_counts));
    int colour = int(tsr_work_word(block + uint(tsr_k_rest)) & 63u);
    uint run = tsr_work_word(block + uint(tsr_k_first));
    uint size = counts & 0xFFFFu;
    if (own_plane == 3u) {
        run += size;
        size = counts >> 16;
    }
    // Where it goes, and the levels of the other planes at its frequency.
    uint before = 0u;
    TsrLevels found;
    found.x = 0u;
    found.y = 0u;
    found.z = 0u;
    bool first_here = true;
    uint rounds = min(size, 3u * uint(tsr_max_coded));
    for (uint i = 0u; i < rounds; ++i) {
        TSR_LOOP;
        uint at = raw_at + (raw + run + i) * 2u;
        uint key = tsr_work_word(at);
        before += key < own_key ? 1u : 0u;
        if (key == own_key) {
            uint level = tsr_work_word(at + 1u);
            if ((level >> 30) < own_plane) {
                before += 1u;
                first_here = false;
            }
            tsr_take_level(found, level);
        }
    }

    uint frequency = own_key >> 12;
    int axes = ((frequency & 31u) != 0u ? 1 : 0) + ((frequency & 0x3E0u) != 0u ? 1 : 0) +
               ((frequency & 0x7C00u) != 0u ? 1 : 0) + ((frequency & 0xF8000u) != 0u ? 1 : 0);
    uint shape = tsr_work_word(block + uint(tsr_k_shape));
    bool rotated = colour != 0 && own_plane < 3u;
    // Steps of 2^(-k / 2) times the file's, in blocks of a base picture (FORMAT.md 4.1).
    uint copies = tsr_copy(tile, own_key & 0xFFFu);
    int k = (copies & tsr_copy_of_base) != 0u ? int((copies >> 16) & 15u) : 0;
    int finer = (k + 1) >> 1;
    int scales = tsr_s_scales + min(axes + (k & 1), 4);
    ivec3 x = ivec3(0);
    if (first_here && own_plane == 3u)
        x.x = tsr_dequantize(found.x, tsr_shape(shape, scales + 15), finer, tsr_t_offsets + 2);
    else if (first_here) {
        x.x = tsr_dequantize(found.x, tsr_shape(shape, scales + (rotated ? 20 : 0)), finer,
                             tsr_t_offsets);
        x.y = tsr_dequantize(found.y, tsr_shape(shape, scales + (rotated ? 20 : 5)), finer,
                             tsr_t_offsets + 2);
        x.z = tsr_dequantize(found.z, tsr_shape(shape, scales + (rotated ? 20 : 10)), finer,
                             tsr_t_offsets + 2);
    }
    if (rotated)
        x = ivec3(tsr_turn_back(x, colour - 1, 0), tsr_turn_back(x, colour - 1, 1),
                  tsr_turn_back(x, colour - 1, 2));
    uint sorted = raw + run + before;
    if (sorted < uint(tsr_coefficients.length()))
        tsr_coefficients[sorted] = uvec4(frequency, uint(x.x), uint(x.y), uint(x.z));
}

#ifndef __cplusplus
layout(local_size_x = 64) in;
void main() {
    // Rows of 2^16 levels: no axis of a dispatch is longer than every device allows.
    tsr_order_level(gl_WorkGroupID.y * 65536u + gl_GlobalInvocationID.x);
}
#endif
