// The decoder's four buffers, and access that is checked against their lengths: whatever an index
// holds, nothing outside is read or written.
#ifndef TSR_BUFFERS
#define TSR_BUFFERS
#include "dialect.glsl"
#include "layout.glsl"

#ifndef __cplusplus
layout(std430, binding = 0) restrict readonly buffer TesseraTables { uint tsr_tables[]; };
layout(std430, binding = 1) restrict readonly buffer TesseraBatch { uint tsr_batch[]; };
// Invocations of border.comp read what others of their group have written. WGSL has no such
// qualifier, but its barriers suffice.
#if defined(TSR_COHERENT_WORK) && !defined(TSR_TRANSLATED)
layout(std430, binding = 2) coherent restrict buffer TesseraWork { uint tsr_work[]; };
#else
layout(std430, binding = 2) restrict buffer TesseraWork { uint tsr_work[]; };
#endif
layout(std430, binding = 3) restrict buffer TesseraCoefficients { uvec4 tsr_coefficients[]; };
#define TSR_ATOMIC_ADD(index, value) atomicAdd(tsr_work[index], value)
#define TSR_ATOMIC_OR(index, value) atomicOr(tsr_work[index], value)
#endif

uint tsr_table(uint at) {
    return at < uint(tsr_tables.length()) ? tsr_tables[at] : 0u;
}
uint tsr_table(int at) {
    return tsr_table(uint(at));
}
uint tsr_shape(uint shape, int field) {
    return tsr_table(tsr_table(tsr_t_shapes) + shape * uint(tsr_shape_words) + uint(field));
}
// Sides along u, v, s, t, within the format's limits even for a shape that does not exist.
ivec4 tsr_sides_of(uint shape) {
    uint sides = tsr_shape(shape, tsr_s_sides);
    return min(ivec4(int(sides & 511u), int((sides >> 9) & 511u), int((sides >> 18) & 63u),
                     int(sides >> 24)),
               ivec4(tsr_max_tile_side, tsr_max_tile_side, tsr_max_angular_side,
                     tsr_max_angular_side));
}

// u, v, s, t of a packed origin (tsr_k_place).
ivec4 tsr_origin_of(uint place) {
    int most = tsr_max_tile_side - 1;
    return ivec4(int(place) & most, int(place >> tsr_place_v) & most,
                 int(place >> tsr_place_s) & (tsr_max_angular_side - 1),
                 int(place >> tsr_place_t) & (tsr_max_angular_side - 1));
}

uint tsr_batch_word(uint at) {
    return at < uint(tsr_batch.length()) ? tsr_batch[at] : 0u;
}
uint tsr_header(int field) {
    return tsr_batch_word(uint(field));
}
uint tsr_work_word(uint at) {
    return at < uint(tsr_work.length()) ? tsr_work[at] : 0u;
}
void tsr_set_work(uint at, uint value) {
    if (at < uint(tsr_work.length()))
        tsr_work[at] = value;
}

uint tsr_tile(uint tile, int field) {
    return tsr_batch_word(tsr_header(tsr_b_tile_at) + tile * uint(tsr_tile_words) + uint(field));
}
uint tsr_segment(uint segment, int field) {
    return tsr_batch_word(tsr_header(tsr_b_segment_at) + segment * uint(tsr_segment_words) +
                          uint(field));
}
uint tsr_state_at(uint tile) {
    return uint(tsr_w_state) + tile * uint(tsr_state_words);
}
// Word of a block's record, or tsr_nowhere if the tile has no room for it.
uint tsr_block_at(uint tile, uint block) {
    if (block >= tsr_tile(tile, tsr_tile_block_room))
        return tsr_nowhere;
    return tsr_header(tsr_b_blocks_at) +
           (tsr_tile(tile, tsr_tile_blocks) + block) * uint(tsr_block_words);
}
uint tsr_item_at(uint item) {
    if (item >= tsr_header(tsr_b_items_room))
        return tsr_nowhere;
    return tsr_header(tsr_b_items_at) + item * uint(tsr_item_words);
}
// The copy record of a block (tsr_copy_words); 0 if the tile is not predicted.
uint tsr_copy(uint tile, uint block) {
    uint copies = tsr_tile(tile, tsr_tile_copies);
    if (copies == tsr_none)
        return 0u;
    return tsr_batch_word(tsr_header(tsr_b_copies_at) + copies + block * uint(tsr_copy_words));
}
bool tsr_is_damaged(uint tile) {
    return tsr_work_word(tsr_state_at(tile) + uint(tsr_st_damaged)) != 0u;
}
void tsr_damage(uint tile, uint what) {
    uint at = tsr_state_at(tile) + uint(tsr_st_damaged);
    if (at < uint(tsr_work.length()))
        TSR_ATOMIC_OR(at, what);
}

// The little-endian 16-bit word of the payloads that begins at a byte.
uint tsr_payload_word(uint byte_at) {
    uint at = tsr_header(tsr_b_payload_at) + (byte_at >> 2);
    uint shift = (byte_at & 3u) * 8u;
    uint word = tsr_batch_word(at) >> shift;
    if (shift == 24u)
        word |= tsr_batch_word(at + 1u) << 8;
    return word & 0xFFFFu;
}

#endif
