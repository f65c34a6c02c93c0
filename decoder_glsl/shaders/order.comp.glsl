// Pass 3, one invocation per level: dequantises it (FORMAT.md 4.1), undoes the colour of its block
// (4.4) and moves it to its position in the order in which the inverse transform sums: by t, s, v
// and u frequency, u fastest.
//
// An invocation finds this position by counting the coefficients of its block that come earlier.
// Blocks hold tens of levels, and all invocations of a block read the same ones.
#include "buffers.glsl"

// The coefficient of a level, within 2^26 of 0; 0 where there is no level. `finer` is subtracted
// from the exponent of the scale.
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

// Row `row` of a rotation times x, rounded as 4.4 says. The sums fit 32 bits.
int tsr_turn_back(ivec3 x, int rotation, int row) {
    int at = tsr_t_rotation + rotation * 9 + row * 3;
    uint a = tsr_table(at);
    uint b = tsr_table(at + 1);
    uint c = tsr_table(at + 2);
    uint high = a * uint(x.x >> 11) + b * uint(x.y >> 11) + c * uint(x.z >> 11);
    uint low = a * uint(x.x & 2047) + b * uint(x.y & 2047) + c * uint(x.z & 2047);
    return int(high + uint(int(low + 2048u) >> 11)) >> 1;
}

// The coefficient of a chroma plane with its share of luma, which counts `unit` of
// 4096. Rounded as 4.4 says. The sums fit 32 bits.
int tsr_add_luma(int chroma, int luma, int share, int unit) {
    uint weight = uint(share * unit);
    uint high = weight * uint(luma >> 11) + 4096u * uint(chroma >> 11);
    uint low = weight * uint(luma & 2047) + 4096u * uint(chroma & 2047);
    return int(high + uint(int(low + 2048u) >> 11)) >> 1;
}

// The levels of one frequency of a block, and the position of their coefficient.
struct TsrLevels {
    uint x; // planes 0 to 2; plane 3 is in x
    uint y;
    uint z;
    uint before;     // number of levels that come earlier in the order
    bool first_here; // no lower plane has a level at this frequency
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

// Looks through the `count` raw levels from word `first` on for those at the frequency of
// `own_key`, of which `own_plane` has one.
TsrLevels tsr_find_levels(uint first, uint count, uint own_key, uint own_plane) {
    TsrLevels found;
    found.x = 0u;
    found.y = 0u;
    found.z = 0u;
    found.before = 0u;
    found.first_here = true;
    for (uint i = 0u; i < count; ++i) {
        TSR_LOOP;
        uint at = first + i * uint(tsr_raw_words);
        uint key = tsr_work_word(at);
        found.before += key < own_key ? 1u : 0u;
        if (key == own_key) {
            uint level = tsr_work_word(at + 1u);
            if ((level >> 30) < own_plane) {
                found.before += 1u;
                found.first_here = false;
            }
            tsr_take_level(found, level);
        }
    }
    return found;
}

// The logarithm of a side that is a power of 2, at most tsr_max_sine_side.
int tsr_log2_of_side(int side) {
    return side >= 32 ? 5 : (side >= 16 ? 4 : (side >= 8 ? 3 : (side >= 4 ? 2 : (side >= 2 ? 1 : 0))));
}

// The coefficients of planes 0 to 2, or of plane 3 in x. `colour`: see tsr_k_colour; `copy`: the
// copy record of the block; `block_axes`: see tsr_k_rest.
ivec3 tsr_coefficients_of(TsrLevels found, bool plane_3, uint frequency, uint shape, uint colour,
                          uint copy, uint block_axes) {
    ivec4 sides = tsr_sides_of(shape);
    // Of axes without a transform: the logarithms of their sides (FORMAT.md 4.1).
    int log_u = (block_axes & tsr_plain_u) != 0u ? tsr_log2_of_side(sides.x) : -1;
    int log_v = (block_axes & tsr_plain_v) != 0u ? tsr_log2_of_side(sides.y) : -1;
    bool counts_u = (frequency & 31u) != 0u || (block_axes & tsr_sines_u) != 0u;
    bool counts_v = (frequency & 0x3E0u) != 0u || (block_axes & tsr_sines_v) != 0u;
    int axes = (log_u >= 0 ? log_u & 1 : (counts_u ? 1 : 0)) +
               (log_v >= 0 ? log_v & 1 : (counts_v ? 1 : 0)) +
               ((frequency & 0x7C00u) != 0u ? 1 : 0) + ((frequency & 0xF8000u) != 0u ? 1 : 0);
    // The steps of a base picture's blocks are 2^(-k / 2) times the file's (FORMAT.md 4.1).
    int k = (copy & tsr_copy_of_base) != 0u ? int((copy >> 16) & 15u) : 0;
    int finer = ((k + 1) >> 1) - (max(log_u, 0) >> 1) - (max(log_v, 0) >> 1);
    int scales = tsr_s_scales + min(axes + (k & 1), tsr_scales_of_set - 1);
    int first_offset = tsr_t_offsets;
    int other_offset = tsr_t_offsets + 2;
    ivec3 x = ivec3(0);
    if (plane_3) {
        x.x = tsr_dequantize(found.x, tsr_shape(shape, scales + 3 * tsr_scales_of_set), finer,
                             other_offset);
        return x;
    }
    bool rotated = colour != 0u && colour < tsr_colour_shares;
    int rotated_scales = scales + 4 * tsr_scales_of_set;
    x.x = tsr_dequantize(found.x, tsr_shape(shape, rotated ? rotated_scales : scales), finer,
                         first_offset);
    x.y = tsr_dequantize(
        found.y, tsr_shape(shape, rotated ? rotated_scales : scales + tsr_scales_of_set), finer,
        other_offset);
    x.z = tsr_dequantize(
        found.z, tsr_shape(shape, rotated ? rotated_scales : scales + 2 * tsr_scales_of_set), finer,
        other_offset);
    if (rotated) {
        int rotation = min(int(colour), tsr_rotations) - 1;
        x = ivec3(tsr_turn_back(x, rotation, 0), tsr_turn_back(x, rotation, 1),
                  tsr_turn_back(x, rotation, 2));
    } else if (colour != 0u && (frequency != 0u || (copy & (3u | tsr_copy_of_border)) != 0u)) {
        // The means of blocks without a prediction are not related.
        x.y = tsr_add_luma(x.y, x.x, int(colour << 8) >> 24, 256);
        x.z = tsr_add_luma(x.z, x.x, int(colour) >> 24, 128);
    }
    return x;
}

// `slot`: number of the raw level.
void tsr_order_level(uint slot) {
    uint chunk = slot / uint(tsr_raw_chunk);
    if (chunk >= tsr_header(tsr_b_raw_chunks))
        return;
    uint segment = tsr_batch_word(tsr_header(tsr_b_raw_chunk_at) + chunk);
    uint raw = tsr_segment(segment, tsr_seg_raw);
    uint tile = tsr_segment(segment, tsr_seg_tile);
    if (slot - raw >= tsr_work_word(tsr_header(tsr_b_counts_at) + segment) || tsr_is_damaged(tile))
        return;
    uint raw_at = tsr_header(tsr_b_raw_at);
    uint own_key = tsr_work_word(raw_at + slot * uint(tsr_raw_words));
    uint own_level = tsr_work_word(raw_at + slot * uint(tsr_raw_words) + 1u);
    uint own_plane = own_level >> 30;
    bool plane_3 = own_plane == 3u;

    // Planes 0 to 2 are sorted together, and plane 3 behind them.
    uint block = tsr_block_at(tile, own_key & 0xFFFu);
    uint counts = tsr_work_word(block + uint(tsr_k_counts));
    uint run = raw + tsr_work_word(block + uint(tsr_k_first));
    uint size = counts & 0xFFFFu;
    if (plane_3) {
        run += size;
        size = counts >> 16;
    }
    size = min(size, 3u * uint(tsr_max_coded));
    TsrLevels found =
        tsr_find_levels(raw_at + run * uint(tsr_raw_words), size, own_key, own_plane);

    // The invocation of the lowest plane writes the coefficients of all planes, the others write 0.
    uint frequency = own_key >> 12;
    ivec3 x = ivec3(0);
    if (found.first_here)
        x = tsr_coefficients_of(found, plane_3, frequency,
                                tsr_work_word(block + uint(tsr_k_shape)),
                                tsr_work_word(block + uint(tsr_k_colour)),
                                tsr_copy(tile, own_key & 0xFFFu),
                                tsr_work_word(block + uint(tsr_k_rest)));
    uint sorted = run + found.before;
    if (sorted < uint(tsr_coefficients.length()))
        tsr_coefficients[sorted] = uvec4(frequency, uint(x.x), uint(x.y), uint(x.z));
}

#ifndef __cplusplus
layout(local_size_x = TSR_TEXEL_GROUP) in;
void main() {
    tsr_order_level(gl_WorkGroupID.y * uint(tsr_row_groups * TSR_TEXEL_GROUP) +
                    gl_GlobalInvocationID.x);
}
#endif
